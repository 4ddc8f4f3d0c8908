"""CircularCartesian: an arc or a full circle of the tool."""

from collections.abc import Sequence
from typing import Any, ClassVar

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.paths.circular_arc import CircularArc, Orientation
from robots_planning.trajectory_generators.poses_generator import PosesGenerator


class CircularCartesian(PosesGenerator):
    """The tool moves on a circle. The target is (via, end), or (via, second via, start) for a full circle.

    Args:
        robot: The robot.
        orientation: 'interpolated' or 'along_path', see `CircularArc`.
        options: See `CartesianGenerator`.

    Raises:
        InvalidInputError: an unknown orientation when planning, or a bad option.
    """

    kinds: ClassVar[tuple[str, ...]] = ('circle',)

    def __init__(
        self, robot: BaseRobotModel, *, orientation: Orientation = 'interpolated', **options: Any
    ) -> None:
        super().__init__(robot, **options)
        self.orientation = orientation

    def path(self, start: Pose, poses: Sequence[Pose]) -> CircularArc:
        """The arc from `start` over a via point to an end, or the circle over two via points to the start.

        Raises:
            InvalidInputError: another number of poses, or points that determine no circle.
        """
        if len(poses) not in (2, 3):
            raise InvalidInputError(
                f'a circular motion needs 2 poses (via, end) or 3 (via, second via, start), got {len(poses)}'
            )
        second_via = poses[1] if len(poses) == 3 else None
        return CircularArc(start, poses[0], poses[-1], second_via=second_via, orientation=self.orientation)
