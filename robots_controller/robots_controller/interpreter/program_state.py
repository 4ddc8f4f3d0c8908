"""ProgramState: the paper's data core, shared by the program's thread and the robot's side."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_controller.interpreter.clock import Clock
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector, read_only
from robots_planning.robot_command_state import RobotCommandState


class RunState(StrEnum):
    """What the program does."""

    IDLE = 'IDLE'  # none is open
    OPENED = 'OPENED'
    RUNNING = 'RUNNING'
    PAUSED = 'PAUSED'
    STOPPED = 'STOPPED'
    FINISHED = 'FINISHED'
    FAILED = 'FAILED'


class ProgramStopped(BaseException):
    """Raised in the program's thread wherever it waits, once it shall stop; not an error."""


@dataclass(frozen=True, eq=False)
class MotionCommand:
    """One motion as the program commands it.

    Attributes:
        state: The kind of motion.
        line: The program's line, counted from 1.
        function: The Lua function's name.
        q: Target in joint space (n,), rad (m), read-only; None for a target pose.
        pose: Target of tool0 in the base frame; None for a joint target.
        options: Further wishes of this motion; none yet.
    """

    state: RobotCommandState
    line: int
    function: str
    q: Array | None = None
    pose: Pose | None = None
    options: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True)
class OutputChange:
    """One output that the program switched.

    Attributes:
        kind: 'digital' or 'analog'.
        index: Counted from 1.
        value: 0 or 1, or the analog value.
        line: The program's line.
    """

    kind: Literal['digital', 'analog']
    index: int
    value: float
    line: int


class ProgramState:
    """Command state, motion, reference pose, I/O images and overrides, safe from any thread.

    One condition variable guards everything and wakes everyone who waits; a stop interrupts every wait.

    Args:
        num_axes: n.
        digital: Number of digital inputs, and of digital outputs.
        analog: Number of analog inputs, and of analog outputs.
        clock: The program's time.

    Raises:
        InvalidInputError: sizes that are not at least 1.
    """

    def __init__(self, num_axes: int, *, digital: int, analog: int, clock: Clock) -> None:
        for name, size in (('num_axes', num_axes), ('digital', digital), ('analog', analog)):
            check_count(size, name)
        self.condition = threading.Condition()
        self.clock = clock
        self._num_axes = num_axes
        self._run_state = RunState.IDLE
        self._stopping = False
        self._command_state = RobotCommandState.IDLE
        self._motion: MotionCommand | None = None
        self._motion_error: RobotsError | None = None
        self._reference_pose: Pose | None = None
        self._overrides = read_only(np.ones(num_axes))
        self._digital_inputs = np.zeros(digital, dtype=np.bool_)
        self._digital_outputs = np.zeros(digital, dtype=np.bool_)
        self._analog_inputs = np.zeros(analog)
        self._analog_outputs = np.zeros(analog)

    # -- the run --------------------------------------------------------------------------------

    @property
    def run_state(self) -> RunState:
        """What the program does."""
        with self.condition:
            return self._run_state

    @property
    def running(self) -> bool:
        """The program has begun and not ended; it may be paused."""
        return self.run_state in (RunState.RUNNING, RunState.PAUSED)

    @property
    def stopping(self) -> bool:
        """The program was told to stop."""
        with self.condition:
            return self._stopping

    def set_run_state(self, state: RunState) -> None:
        """Set what the program does; beginning to run forgets an earlier stop."""
        with self.condition:
            if state is RunState.RUNNING and self._run_state is not RunState.PAUSED:
                self._stopping = False
                self._motion_error = None
            self._run_state = state
            self.condition.notify_all()

    def stop(self) -> bool:
        """Tell the program to stop; it does so at its next instruction or where it waits.

        Returns:
            True if it was running.
        """
        with self.condition:
            if self._run_state not in (RunState.RUNNING, RunState.PAUSED):
                return False
            self._stopping = True
            self.condition.notify_all()
            return True

    def change_run_state(self, expected: RunState, state: RunState) -> bool:
        """Change from one run state to another, if the program is in the first one and shall not stop."""
        with self.condition:
            if self._run_state is not expected or self._stopping:
                return False
            self._run_state = state
            self.condition.notify_all()
            return True

    def hold(self) -> None:
        """Return at once while the program runs; wait while it is paused.

        Raises:
            ProgramStopped: the program shall stop.
        """
        with self.condition:
            while self._run_state is RunState.PAUSED and not self._stopping:
                self.clock.wait(self.condition, None)
            if self._stopping:
                raise ProgramStopped

    def sleep(self, duration: float) -> None:
        """Wait for `duration` seconds of the program's clock; the time of a pause does not count.

        Raises:
            ProgramStopped: the program shall stop.
        """
        remaining = duration
        with self.condition:
            while True:
                self.hold()
                if remaining <= 0.0:
                    return
                start = self.clock.now()
                self.clock.wait(self.condition, start + remaining)
                remaining -= self.clock.now() - start

    # -- the motion -----------------------------------------------------------------------------

    @property
    def num_axes(self) -> int:
        """Number of axes n."""
        with self.condition:
            return self._num_axes

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
            self._num_axes = num_axes
            self._overrides = read_only(np.ones(num_axes))

    @property
    def command_state(self) -> RobotCommandState:
        """What the robot is commanded to do."""
        with self.condition:
            return self._command_state

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
                self._command_state = state

    @property
    def motion(self) -> MotionCommand | None:
        """The motion that is commanded and not finished."""
        with self.condition:
            return self._motion

    @property
    def reference_pose(self) -> Pose | None:
        """The last commanded target of tool0 in the base frame; None before the first."""
        with self.condition:
            return self._reference_pose

    def command_motion(self, command: MotionCommand) -> None:
        """Set a motion and its command state.

        Raises:
            ProgramError: an earlier motion has not finished.
        """
        with self.condition:
            if self._motion is not None:
                raise ProgramError(f'the motion of line {self._motion.line} has not finished')
            self._motion = command
            self._motion_error = None
            self._command_state = command.state
            if command.pose is not None:
                self._reference_pose = command.pose

    def finish_motion(self, error: RobotsError | None = None) -> None:
        """End the motion: IDLE again, and the program goes on, or is told the error."""
        with self.condition:
            self._command_state = RobotCommandState.IDLE
            self._motion_error = error if self._motion is not None else None
            self._motion = None
            self.condition.notify_all()

    def wait_for_motion(self) -> None:
        """Wait until the motion has finished, and while the program is paused.

        Raises:
            ProgramStopped: the program shall stop.
            RobotsError: the reason why the robot does not stand at the target.
        """
        with self.condition:
            while self._motion is not None and not self._stopping:
                self.clock.wait(self.condition, None)
            self.hold()
            error, self._motion_error = self._motion_error, None
            if error is not None:
                raise error

    # -- inputs, outputs, overrides ----------------------------------------------------------------

    @property
    def overrides(self) -> Array:
        """Speed scale factor per axis, (n,), 0..1, read-only."""
        with self.condition:
            return self._overrides

    @property
    def digital_inputs(self) -> NDArray[np.bool_]:
        """Image of the digital inputs, a copy; the first is input 1."""
        with self.condition:
            return self._digital_inputs.copy()

    @property
    def digital_outputs(self) -> NDArray[np.bool_]:
        """Image of the digital outputs, a copy; the first is output 1."""
        with self.condition:
            return self._digital_outputs.copy()

    @property
    def analog_inputs(self) -> Array:
        """Image of the analog inputs, a copy; the first is input 1."""
        with self.condition:
            return self._analog_inputs.copy()

    @property
    def analog_outputs(self) -> Array:
        """Image of the analog outputs, a copy; the first is output 1."""
        with self.condition:
            return self._analog_outputs.copy()

    def set_digital_inputs(self, values: ArrayLike) -> None:
        """Set inputs 1..k to the k values, each 0 or 1; further inputs keep theirs.

        Raises:
            InvalidInputError: more values than inputs, or a value other than 0 and 1.
        """
        array = _image(values, self._digital_inputs.size, 'digital_inputs')
        if wrong := np.flatnonzero((array != 0.0) & (array != 1.0)).tolist():
            raise InvalidInputError(f'digital input {wrong[0] + 1} is {array[wrong[0]]:g}; valid are 0 and 1')
        with self.condition:
            self._digital_inputs[: array.size] = array != 0.0

    def set_analog_inputs(self, values: ArrayLike) -> None:
        """Set inputs 1..k to the k values; further inputs keep theirs.

        Raises:
            InvalidInputError: more values than inputs, or a value that is not finite.
        """
        array = _image(values, self._analog_inputs.size, 'analog_inputs')
        with self.condition:
            self._analog_inputs[: array.size] = array

    def set_output(self, kind: Literal['digital', 'analog'], index: int, value: float) -> bool:
        """Switch one output.

        Args:
            kind: 'digital' or 'analog'.
            index: Counted from 1, inside the image.
            value: 0 or 1, or the analog value.

        Returns:
            True if the output changed.
        """
        with self.condition:
            image = self._digital_outputs if kind == 'digital' else self._analog_outputs
            changed = bool(image[index - 1] != value)
            image[index - 1] = value
            return changed


def check_count(size: int, name: str) -> None:
    """Check a number of axes, inputs or outputs.

    Raises:
        InvalidInputError: not a whole number, or below 1.
    """
    if isinstance(size, bool) or not isinstance(size, int) or size < 1:
        raise InvalidInputError(f'{name} = {size!r} must be a whole number of at least 1')


def _image(values: ArrayLike, size: int, name: str) -> Array:
    try:
        count = len(values)  # type: ignore[arg-type]
    except TypeError:
        raise InvalidInputError(f'{name} must be a list of up to {size} values, got {values!r}') from None
    if count > size:
        raise InvalidInputError(f'{name} has {count} values; the program has {size}')
    return finite_vector(values, count, name)
