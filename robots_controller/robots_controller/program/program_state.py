"""ProgramState: the paper's data core, shared by the program's thread and the robot's side."""

import math
import threading
from collections.abc import Callable, Generator, Mapping, Sequence
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robots_controller.io.io_image import IoImage, check_count
from robots_controller.program.background_tasks import BackgroundTasks
from robots_controller.program.clock import Clock
from robots_controller.program.input_interrupts import InputInterrupts
from robots_controller.program.motion_command import MotionCommand, OutputChange
from robots_controller.program.run_state import ProgramStopped, RunState
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import finite_vector, read_only
from robots_planning.robot_command_state import RobotCommandState

__all__ = ['MotionCommand', 'OutputChange', 'ProgramState', 'ProgramStopped', 'RunState']


class ProgramState:
    """Command state, motion, reference pose, I/O images and overrides, safe from any thread.

    One condition variable guards all changes and wakes all waiting threads; a stop interrupts every wait.
    What the attributes say may be read at any time; methods change it.

    Args:
        num_axes: n.
        digital: Number of digital inputs, and of digital outputs.
        analog: Number of analog inputs, and of analog outputs.
        clock: The program's time.
        labels: Names of the channels of an image, see `IoImage`.

    Attributes:
        io: All inputs and outputs.
        run_state: What the program does.
        stopping: A stop of the program was requested.
        num_axes: n.
        command_state: What the robot is commanded to do.
        reference_pose: Where the last commanded motion leads the tool, seen from the base; None for unknown.
        overrides: Speed scale factor per axis, (n,), 0..1, read-only.
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
    ) -> None:
        check_count(num_axes, 'num_axes')
        self.condition = threading.Condition()
        self.io = IoImage(digital=digital, analog=analog, labels=labels, condition=self.condition)
        self.clock = clock
        self.num_axes = num_axes
        self.run_state = RunState.IDLE
        self.stopping = False
        self.command_state = RobotCommandState.IDLE
        self._motions: list[MotionCommand] = []
        self._motion_error: tuple[MotionCommand, RobotsError] | None = None
        self.reference_pose: Pose | None = None
        self.overrides = read_only(np.ones(num_axes))
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
        """Set what the program does; beginning to run forgets an earlier stop."""
        with self.condition:
            if state is RunState.RUNNING and self.run_state is not RunState.PAUSED:
                self.stopping = False
                self._motion_error = None
                self.interrupts = InputInterrupts()
                self.tasks = BackgroundTasks(self.clock)
                self.braked, self._alarm = False, None
            self.run_state = state
            self.condition.notify_all()

    def stop(self) -> bool:
        """Request a stop of the program; it stops at its next instruction or where it waits.

        Returns:
            True if it was running.
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
        """Hold the motion under way for the handler of an input, or let it go on."""
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
        """The program is paused, the handler of an input is due, a task can go on, or the alarm is due.

        Raises:
            ProgramStopped: the program shall stop.
        """
        with self.condition:
            if self.stopping:
                raise ProgramStopped
            if self.interrupts.look() or self.tasks.next() is not None:
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

    def set_num_axes(self, num_axes: int) -> None:
        """Define the number of axes; not while a program runs.

        Raises:
            InvalidInputError: below 1.
            ProgramError: a program runs.
        """
        check_count(num_axes, 'num_axes')
        with self.condition:
            if self.running:
                raise ProgramError('the number of axes cannot change while a program runs; stop it first')
            self.num_axes = num_axes
            self.overrides = read_only(np.ones(num_axes))

    def set_command_state(self, state: RobotCommandState | str) -> None:
        """Set the command state; IDLE ends the motion that was commanded.

        Raises:
            InvalidInputError: not a command state.
        """
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
                self.command_state = state

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
            self.command_state = command.kind.state
            self.reference_pose = reference_pose

    def finish_motion(self, error: RobotsError | None = None, command: MotionCommand | None = None) -> None:
        """End a motion: the program goes on, or gets the error; IDLE again after the last one.

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
                self.command_state = RobotCommandState.IDLE
            self.condition.notify_all()

    def take_motion_error(self) -> tuple[MotionCommand, RobotsError] | None:
        """The first motion that failed and why, once."""
        with self.condition:
            error, self._motion_error = self._motion_error, None
            return error

    # -- inputs, outputs, overrides ----------------------------------------------------------------

    def set_overrides(self, values: ArrayLike) -> None:
        """Set the speed scale factors.

        Raises:
            InvalidInputError: not one number in 0..1 per axis.
        """
        with self.condition:
            overrides = finite_vector(values, self.num_axes, 'overrides')
            if ((overrides < 0.0) | (overrides > 1.0)).any():
                raise InvalidInputError(f'overrides = {overrides.tolist()}; valid is 0..1 for every axis')
            self.overrides = read_only(overrides)

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
