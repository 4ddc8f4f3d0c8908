"""ProgramState: the paper's data core, shared by the program's thread and the robot's side."""

import math
import threading
from collections.abc import Callable, Generator, Mapping, Sequence
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_controller.io.io_image import IoImage, check_count
from robots_controller.program.background_tasks import BackgroundTasks
from robots_controller.program.clock import Clock
from robots_controller.program.input_interrupts import InputInterrupts
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.program.run_state import ProgramStopped, RunState
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector, read_only
from robots_planning.robot_command_state import RobotCommandState


class ProgramState:
    """Command state, motion, reference pose, I/O images and overrides, safe from any thread.

    One condition variable guards all changes and wakes all waiting threads; a stop interrupts every wait.
    The attributes may be read at any time; methods change them.

    The arguments are those of `LuaProgram`, and the clock of its cell.

    Attributes:
        io: All inputs and outputs.
        run_state: What the program does.
        runs: How often a program has begun to run.
        stopping: A stop of the program was requested.
        prismatic: Per axis, whether it slides; () if unknown.
        reference_cartesian_position: Where the last commanded motion leads the tool, seen from the base. None
            before the first, and after a joint motion in a cell that has no kinematics.
        braked: The handler of an input runs, and the motion under way is held for it.

    Raises:
        InvalidInputError: sizes that are not at least 1, or names that are not valid.
    """

    def __init__(
        self,
        num_axes: int,
        *,
        digital: int,
        analog: int,
        clock: Clock,
        labels: Mapping[str, Sequence[str]] = MappingProxyType({}),
        prismatic: tuple[bool, ...] = (),
    ) -> None:
        check_count(num_axes, 'num_axes')
        self.condition = threading.Condition()
        self.io = IoImage(digital=digital, analog=analog, labels=labels, condition=self.condition)
        self.clock = clock
        self.prismatic = prismatic
        self._num_axes = num_axes
        self.run_state = RunState.IDLE
        self.runs = 0
        self.stopping = False
        self._command_state = RobotCommandState.IDLE
        self._motions: list[MotionCommand] = []
        self._motion_error: tuple[MotionCommand, RobotsError] | None = None
        self.reference_cartesian_position: Pose | None = None
        self._overrides = read_only(np.ones(num_axes))
        self.interrupts = InputInterrupts()
        self.tasks = BackgroundTasks(clock)
        self.braked = False
        self._alarm: float | None = None

    # -- the run --------------------------------------------------------------------------------

    @property
    def running(self) -> bool:
        """The program has begun and not ended; it may be paused."""
        return self.run_state in (RunState.RUNNING, RunState.PAUSED)

    def set_run_state(self, state: RunState) -> None:
        """Set what the program does; beginning to run clears an earlier stop."""
        with self.condition:
            if state is RunState.RUNNING and self.run_state is not RunState.PAUSED:
                self.runs += 1
                self.stopping = False
                self._motion_error = None
                self.interrupts = InputInterrupts()
                self.tasks = BackgroundTasks(self.clock)
                self.braked, self._alarm = False, None
            self.run_state = state
            self.condition.notify_all()

    def stop(self) -> bool:
        """Stop the program for good, at its next instruction or where it waits.

        A commanded motion is the robot's side to stop.

        Returns:
            True if it was running. It ends a moment later.
        """
        with self.condition:
            if not self.running:
                return False
            self.stopping = True
            self.condition.notify_all()
            return True

    def change_run_state(self, expected: RunState, state: RunState) -> bool:
        """Change from one run state to another, if the program is in the first one and shall not stop."""
        with self.condition:
            if self.run_state is not expected or self.stopping:
                return False
            self.run_state = state
            self.condition.notify_all()
            return True

    def set_braked(self, *, braked: bool) -> None:
        """Hold the motion under way for the handler of an input, or let it continue."""
        with self.condition:
            self.braked = braked
            self.condition.notify_all()

    @property
    def robot_held(self) -> bool:
        """The robot shall stand on its path: the program is paused, or handles an input."""
        return self.braked or self.run_state is RunState.PAUSED

    def set_alarm(self, time: float | None) -> None:
        """The program must attend to something at this time of its clock, s; None for nothing."""
        with self.condition:
            self._alarm = time

    def hold(self) -> None:
        """Wait while the program is paused, until the alarm at most.

        Raises:
            ProgramStopped: the program shall stop.
        """
        with self.condition:
            while self.run_state is RunState.PAUSED and not self.stopping and not self._alarm_is_due():
                self.clock.wait(self.condition, self._alarm)
            if self.stopping:
                raise ProgramStopped

    def wait_for_standstill(self) -> None:
        """Wait until no motion is under way, whatever else happens.

        Raises:
            ProgramStopped: the program shall stop.
        """
        with self.condition:
            while self._motions and not self.stopping:
                self.clock.wait(self.condition, None)
            if self.stopping:
                raise ProgramStopped

    def needs_attention(self) -> bool:
        """The program is paused, the handler of an input is due, a task can continue, or the alarm is due.

        Raises:
            ProgramStopped: the program shall stop.
        """
        with self.condition:
            if self.stopping:
                raise ProgramStopped
            if self.interrupts.check() or self.tasks.next() is not None:
                return True
            return self.run_state is RunState.PAUSED or self._alarm_is_due()

    def _alarm_is_due(self) -> bool:
        return self._alarm is not None and self.clock.now() >= self._alarm

    def waiting(
        self, ready: Callable[[], bool], duration: float | None = None
    ) -> Generator[None, None, bool]:
        """Wait for a condition; yields where the program must attend to something, and then waits on.

        Args:
            ready: The condition, asked whenever something changes.
            duration: s of the program's clock, not counting the time of a pause or a handler; None waits
                for ever.

        Returns:
            True if it is ready, False after `duration`.

        Raises:
            ProgramStopped: the program shall stop.
        """
        remaining = duration
        while True:
            with self.condition:
                while not self.needs_attention():
                    if ready():
                        return True
                    if remaining is not None and remaining <= 0.0:
                        return False
                    start = self.clock.now()
                    ends = [] if remaining is None else [start + remaining]
                    ends += [] if self.tasks.next_time == math.inf else [self.tasks.next_time]
                    ends += [] if self._alarm is None else [self._alarm]
                    self.clock.wait(self.condition, min(ends, default=None))
                    if remaining is not None:
                        remaining -= self.clock.now() - start
            yield

    # -- the motion -----------------------------------------------------------------------------

    @property
    def num_axes(self) -> int:
        """Number of axes n; it cannot change while a program runs."""
        return self._num_axes

    @num_axes.setter
    def num_axes(self, num_axes: int) -> None:
        check_count(num_axes, 'num_axes')
        if self.prismatic and num_axes != len(self.prismatic):
            raise InvalidInputError(f'prismatic names {len(self.prismatic)} axes, num_axes = {num_axes}')
        with self.condition:
            if self.running:
                raise ProgramError('the number of axes cannot change while a program runs; stop it first')
            self._num_axes = num_axes
            self._overrides = read_only(np.ones(num_axes))

    @property
    def command_state(self) -> RobotCommandState:
        """What the robot is commanded to do; setting IDLE ends the motion as `finish_motion` does."""
        return self._command_state

    @command_state.setter
    def command_state(self, state: RobotCommandState | str) -> None:
        try:
            state = RobotCommandState(state)
        except ValueError:
            raise InvalidInputError(
                f'{state!r} is no command state; command states are {", ".join(RobotCommandState)}'
            ) from None
        with self.condition:
            if state is RobotCommandState.IDLE:
                self.finish_motion()
            else:
                self._command_state = state

    @property
    def motion(self) -> MotionCommand | None:
        """The oldest motion that is commanded and not finished."""
        with self.condition:
            return self._motions[0] if self._motions else None

    @property
    def motions(self) -> tuple[MotionCommand, ...]:
        """All motions that are commanded and not finished, oldest first; blended ones follow each other."""
        with self.condition:
            return tuple(self._motions)

    def command_motion(self, command: MotionCommand, reference_pose: Pose | None = None) -> None:
        """Set a motion, its command state, and where it leads the tool.

        Raises:
            ProgramError: an earlier motion has not finished, and does not blend into this one.
        """
        with self.condition:
            if self._motions and not self._motions[-1].blend:
                raise ProgramError(f'the motion of line {self._motions[-1].line} has not finished')
            self._motions.append(command)
            self._command_state = command.kind.state
            self.reference_cartesian_position = reference_pose

    def finish_motion(self, error: RobotsError | None = None, command: MotionCommand | None = None) -> None:
        """End a motion: the program continues, or gets the error; IDLE again after the last one.

        Args:
            error: Why the robot does not stand at the target.
            command: Which motion; the oldest by default. The ones before it have ended too, and after an
                error none follows.
        """
        with self.condition:
            if self._motions and (command is None or command in self._motions):
                command = command or self._motions[0]
                if error is not None:
                    self._motion_error = (command, error)
                    self._motions.clear()
                else:
                    del self._motions[: self._motions.index(command) + 1]
            if not self._motions:
                self._command_state = RobotCommandState.IDLE
            self.condition.notify_all()

    def take_motion_error(self) -> tuple[MotionCommand, RobotsError] | None:
        """The first motion that failed and why, once."""
        with self.condition:
            error, self._motion_error = self._motion_error, None
            return error

    # -- inputs, outputs, overrides ----------------------------------------------------------------

    @property
    def overrides(self) -> Array:
        """Speed scale factor per axis, (n,), 0..1, read-only."""
        return self._overrides

    @overrides.setter
    def overrides(self, values: ArrayLike) -> None:
        with self.condition:
            overrides = finite_vector(values, self.num_axes, 'overrides')
            if ((overrides < 0.0) | (overrides > 1.0)).any():
                raise InvalidInputError(f'overrides = {overrides.tolist()}; valid is 0..1 for every axis')
            self._overrides = read_only(overrides)

    @property
    def digital_inputs(self) -> NDArray[np.bool_]:
        """Image of the digital inputs; set 0s and 1s for inputs 1..k, further inputs keep theirs."""
        return self.io.bits('digital_inputs')

    @digital_inputs.setter
    def digital_inputs(self, values: ArrayLike) -> None:
        self.io.set_inputs('digital', values)

    @property
    def analog_inputs(self) -> Array:
        """Image of the analog inputs; set numbers for inputs 1..k, further inputs keep theirs."""
        return self.io.numbers('analog_inputs')

    @analog_inputs.setter
    def analog_inputs(self, values: ArrayLike) -> None:
        self.io.set_inputs('analog', values)

    @property
    def digital_outputs(self) -> NDArray[np.bool_]:
        """Image of the digital outputs; the first is output 1."""
        return self.io.bits('digital_outputs')

    @property
    def analog_outputs(self) -> Array:
        """Image of the analog outputs; the first is output 1."""
        return self.io.numbers('analog_outputs')

    def set_output(self, kind: Literal['digital', 'analog'], index: int, value: float) -> bool:
        """Switch one output.

        Args:
            kind: 'digital' or 'analog'.
            index: Counted from 1, inside the image.
            value: 0 or 1, or the analog value.

        Returns:
            True if the output changed.
        """
        return self.io.set_value(self.io.channel(kind, 'output', index), value)
