"""RunContext: what all functions of one run share, and Family: functions that belong together."""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

from robots_controller.degrees import pose_to_program
from robots_controller.interpreter.debugger import HoldReason
from robots_controller.interpreter.functions.lua_function import LuaFunction, Serve
from robots_controller.interpreter.lua_sandbox import PoseValues
from robots_controller.program.cell_port import CellPort
from robots_controller.program.files.persistent_values import PersistentValues
from robots_controller.program.motions.guided_motion import GuidedMotion
from robots_controller.program.motions.motion_command import Kind, OutputChange
from robots_controller.program.motions.motion_target import MotionTarget, RobotView
from robots_controller.program.program_state import ProgramState
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.motion_settings import CHECKS

Subprogram = Callable[[str], tuple[str, str]]
"""Gives the name and the text of a program."""


class Waits(Protocol):
    """How functions wait."""

    def standstill(self) -> Generator[None, None, None]:
        """Wait until the robot stands at its last target; see `Motions.standstill`."""

    def waiting(
        self, ready: Callable[[], bool], duration: float | None = None
    ) -> Generator[None, None, bool]:
        """Wait for a condition; see `ProgramState.waiting`."""


class OutputPulses:
    """The digital outputs whose pulses are not over yet.

    Args:
        state: Its clock times the pulses, its alarm wakes the program at the end of the next one.
        switch: Sets a digital output.
    """

    def __init__(self, state: ProgramState, switch: Callable[[int, float], None]) -> None:
        self._state = state
        self._switch = switch
        self._ends: dict[int, float] = {}

    @property
    def any(self) -> bool:
        """Some pulse is not over."""
        return bool(self._ends)

    def start(self, index: int, duration: float) -> None:
        """Switch an output on, for so many s; a pulse that it has ends with this one."""
        self._switch(index, 1.0)
        self._ends[index] = self._state.clock.now() + duration
        self._set_alarm()

    def end(self, *, all_of_them: bool = False) -> None:
        """Switch off the outputs whose pulse is over."""
        now = self._state.clock.now()
        for index, end in list(self._ends.items()):
            if all_of_them or end <= now:
                del self._ends[index]
                self._switch(index, 0.0)
        self._set_alarm()

    def _set_alarm(self) -> None:
        self._state.set_alarm(min(self._ends.values(), default=None))


@dataclass
class RunContext:
    """One run of a program.

    Attributes:
        subprogram: Gives a subprogram's or task's name and text.
        start: When the run began, s.
        settings: Modal settings that the program has changed, by the name of their parameter, SI.
        line: Line of the call that is served.
    """

    state: ProgramState
    cell: CellPort
    view: RobotView
    subprogram: Subprogram
    hold: Callable[[HoldReason], bool]
    waits: Waits = field(init=False)
    settings: dict[str, object] = field(default_factory=dict)
    line: int = 0

    def __post_init__(self) -> None:
        self.target = MotionTarget(self.cell)
        self.guided = GuidedMotion(self.state, self.joint_position, self.cell.guide)
        self.pulses = OutputPulses(self.state, lambda index, value: self.set_output('digital', index, value))
        self.values = PersistentValues(self.view.values_file, kept=not self.cell.simulated)
        self.start = self.state.clock.now()

    def change(self, **settings: Any) -> None:
        """Change modal settings, for the motions that follow.

        Raises:
            InvalidInputError: a value that is not valid; nothing is changed then.
        """
        for name, value in settings.items():
            CHECKS[name](value, name)
        self.settings |= settings

    def shown(self, pose: Pose) -> PoseValues:
        """A pose as the program has it."""
        return PoseValues(pose_to_program(pose.r, pose.angles(self.view.convention)))

    def tool_pose(self) -> Pose:
        """Where the tool is, seen from the base."""
        return self.target.seen(self.cell.kinematics.direct(self.joint_position()))

    def joint_position(self) -> Array:
        """Measured joint positions, (n,), rad (m)."""
        return self.cell.robot.joint_feedback().position

    def set_output(self, kind: Kind, index: int, value: float) -> None:
        """Switch an output."""
        if self.state.set_output(kind, index, value):
            self.cell.output_changed(OutputChange(kind, index, value, self.line))

    def output(self, kind: Kind, index: float) -> float:
        """Value of an output, counted from 1."""
        return self.state.io.value(self.state.io.channel(kind, 'output', int(index)))

    def input(self, kind: Kind, index: float) -> float:
        """Value of an input, counted from 1."""
        return self.state.io.value(self.state.io.channel(kind, 'input', int(index)))


class Family:
    """Functions of robot programs that belong together: rows of the table, and what they do."""

    def __init__(self, run: RunContext) -> None:
        self._run = run

    @classmethod
    def functions(cls) -> tuple[LuaFunction, ...]:
        """Its functions, in the order of the table."""
        return tuple(value for value in vars(cls).values() if isinstance(value, LuaFunction))

    @property
    def handlers(self) -> Mapping[str, Serve]:
        """What serves a call, by the name of the function."""
        return {function.name: partial(function.serve, self) for function in self.functions()}
