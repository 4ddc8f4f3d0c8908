"""CircularCartesian and SplineCartesian: curves of the tool that several poses determine."""

from collections.abc import Sequence
from typing import Any, ClassVar, Self

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings
from robots_planning.paths.circular_arc import CircularArc
from robots_planning.paths.pose_spline import PoseSpline
from robots_planning.planner_choice import load_planner
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.cartesian_generator import CartesianGenerator
from robots_planning.trajectory_generators.trajectory_generator import Target


class PosesGenerator(CartesianGenerator):
    """The tool centre point follows a curve that several poses determine."""

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """See `TrajectoryGenerator.from_settings`; torque is limited if `cartesian_planner` keeps it."""
        keeps_torque = load_planner(settings.cartesian_planner).keeps_torque
        return super().from_settings(robot, settings, keeps_torque=keeps_torque, **options)

    def plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_pose`."""
        return self._plan(start, [target])

    def _plan(self, start: Array, target: Target) -> Trajectory:
        poses = [target] if isinstance(target, Pose) else target
        if not isinstance(poses, Sequence) or not all(isinstance(pose, Pose) for pose in poses):
            raise InvalidInputError(
                f'{type(self).__name__} needs a sequence of Pose as target, got {type(target).__name__}'
            )
        return self.plan_path(self.path(self.path_kinematics.pose(start), poses), start)


class CircularCartesian(PosesGenerator):
    """The tool moves on a circle. The target is (via, end), or (via, second via, start) for a full circle.

    Options: see `CartesianGenerator`.
    """

    kinds: ClassVar[tuple[str, ...]] = ('circle',)

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
        return CircularArc(start, poses[0], poses[-1], second_via=second_via)


class SplineCartesian(PosesGenerator):
    """The tool passes all poses of the target on a smooth curve without a stop; see `PoseSpline`.

    Options: see `CartesianGenerator`.
    """

    kinds: ClassVar[tuple[str, ...]] = ('spline',)

    def path(self, start: Pose, poses: Sequence[Pose]) -> PoseSpline:
        """The spline from `start` through `poses`.

        Raises:
            InvalidInputError: no pose, or two in succession that coincide.
        """
        return PoseSpline([start, *poses])
