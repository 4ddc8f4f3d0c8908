"""A cell without a robot, for tests of robot programs."""

from collections.abc import Callable, Mapping
from typing import Any

from robots_controller.program.clock import Clock
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_core.blocks.following.guide import Guide
from robots_core.errors import ProgramError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.motion_settings import NOTHING


class CellDouble:
    """A `CellPort` in the machine's time, and the robot, its kinematics and its controller too.

    Requests and reports have no effect, except for the functions that are given.
    """

    def __init__(self, **functions: Callable[..., Any]) -> None:
        self.clock, self.payload, self.simulated = Clock(), NOTHING, False
        self.robot = self.kinematics = self.controller = self
        for name, function in functions.items():
            assert callable(getattr(self, name)), name
            setattr(self, name, function)

    def joint_feedback(self) -> JointFeedback:
        raise ProgramError('nothing is measured here')

    def direct(self, _q: Array) -> Pose:
        return Pose.identity()

    def inverse(self, _pose: Pose, _near: Array, _settings: Mapping[str, object]) -> Array:
        raise ProgramError('nothing is reachable here')

    def set_override(self, value: float) -> None: ...

    def command(self, command: MotionCommand) -> None: ...

    def flush(self) -> None: ...

    def abort(self) -> None: ...

    def guide(self, guide: Guide) -> None: ...

    def hold(self, *, held: bool) -> None: ...

    def switch_at_target(self, change: OutputChange) -> None: ...

    def output_changed(self, change: OutputChange) -> None: ...

    def printed(self, text: str, line: int) -> None: ...

    def started(self) -> None: ...

    def line_reached(self, line: int) -> None: ...

    def held_changed(self) -> None: ...

    def interrupted(self) -> None: ...

    def ended(self, error: ProgramError | None) -> None: ...
