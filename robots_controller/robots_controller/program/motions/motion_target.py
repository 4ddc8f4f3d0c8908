"""The robot as a program reads it, and where its last motion leads."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from robots_controller.program.cell_port import CellPort
from robots_core.pose import Pose
from robots_core.validation import Array


@dataclass(frozen=True)
class RobotView:
    """The robot as a program reads it.

    Attributes:
        convention: Order of the orientation angles.
        prismatic: (n,) which axes slide; () for none.
    """

    convention: str
    prismatic: tuple[bool, ...]
    points_file: Path
    values_file: Path
    frames_file: Path

    def pose(self, values: Sequence[float]) -> Pose:
        """A pose of position (m) and orientation angles (rad)."""
        return Pose.from_angles(values[:3], values[3:], self.convention)


class MotionTarget:
    """Where the last motion leads, so that relative ones add up without the feedback's error."""

    def __init__(self, cell: CellPort) -> None:
        self._cell = cell
        self.tool = Pose.identity()
        """Tip of the tool, seen from tool0."""
        self.base = Pose.identity()
        """The program's base, seen from the robot's."""
        self._q: Array | None = None
        self._flange: Pose | None = None

    @property
    def known(self) -> bool:
        """A motion was commanded, and none failed since."""
        return self._q is not None or self._flange is not None

    @property
    def in_joints(self) -> bool:
        """It was a target in joint space."""
        return self._q is not None

    def set(self, q: Array | None, pose: Pose | None) -> None:
        """A motion leads to joint positions, or to a pose of the tool seen from the base."""
        self._q = q
        self._flange = None if pose is None else self.base @ pose @ self.tool.inverse()

    def forget(self) -> None:
        """The robot does not stand at its target."""
        self._q = self._flange = None

    def joints(self) -> Array:
        """Joint positions (n,) of the target, or those of the robot.

        Raises:
            RobotsError: they are not known.
        """
        return self._cell.robot.joint_feedback().position if self._q is None else self._q

    def pose(self) -> Pose:
        """The target as pose of the tool seen from the base; where the robot is, if there is none."""
        return self.seen(self._flange or self._cell.kinematics.direct(self.joints()))

    def seen(self, flange: Pose) -> Pose:
        """A pose of tool0 in the robot's base frame as pose of the tool seen from the program's base."""
        return self.base.inverse() @ flange @ self.tool
