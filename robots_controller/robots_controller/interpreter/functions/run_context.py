"""RunContext: what all functions of one run share."""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from robots_controller.degrees import pose_to_program
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import PoseValues, Result, Waiting
from robots_controller.program.cell_port import CellPort
from robots_controller.program.motion_command import Kind, OutputChange
from robots_controller.program.motion_target import MotionTarget, RobotView
from robots_controller.program.program_state import ProgramState
from robots_core.pose import Pose
from robots_planning.motion_settings import CHECKS

Handlers = Mapping[str, Callable[[Arguments], Result | Waiting]]
"""What serves a call, by the name of the function."""


@dataclass
class RunContext:
    """One run of a program.

    Attributes:
        state: What the program shares with its cell.
        cell: The cell.
        view: What the program sees of the robot.
        target: Where the last motion leads.
        settings: Modal settings that the program has changed, by the name of their parameter, SI.
        line: Line of the call that is served.
    """

    state: ProgramState
    cell: CellPort
    view: RobotView
    target: MotionTarget
    settings: dict[str, object] = field(default_factory=dict)
    line: int = 0

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


class Waits(Protocol):
    """How functions wait."""

    def standstill(self) -> Generator[None, None, None]:
        """Wait until the robot stands at its last target; see `Motions.standstill`."""

    def waiting(
        self, ready: Callable[[], bool], duration: float | None = None
    ) -> Generator[None, None, bool]:
        """Wait for a condition; see `ProgramState.waiting`."""
