"""PosesGenerator: the base class of motions through several poses."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, Self

from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import Target
from robots_planning.trajectory_generators.cartesian_generator import CartesianGenerator


class PosesGenerator(CartesianGenerator):
    """The tool centre point follows a curve that several poses determine."""

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """See `TrajectoryGenerator.from_settings`; the algorithm is that of `cartesian_planner`."""
        return super().from_settings(robot, settings, planner=settings.cartesian_planner, **options)

    def generate(self, q_start: ArrayLike, target: Target) -> Trajectory:
        """Plan a motion from rest to rest.

        Args:
            q_start: Joint positions to start from, (n,), rad (m).
            target: Poses of the tool centre point in the base frame, in the order of the motion; without the
                start.

        Raises:
            JointLimitError: the start is outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the last pose.
            PlanningError: the motion is impossible; says where and why.
            InvalidInputError: poses that determine no path, or a target that is not of poses.
        """
        poses = [target] if isinstance(target, Pose) else target
        if not isinstance(poses, Sequence) or not all(isinstance(pose, Pose) for pose in poses):
            raise InvalidInputError(
                f'{type(self).__name__} needs a sequence of Pose as target, got {type(target).__name__}'
            )
        start = self.robot.axes_data.check_position(q_start, 'q_start')
        trajectory = self._plan_through([pose for pose in poses if isinstance(pose, Pose)], start)
        self._check(trajectory, start)
        return trajectory

    @abstractmethod
    def path(self, start: Pose, poses: Sequence[Pose]) -> CartesianPath:
        """The path from pose `start` through `poses`.

        Raises:
            InvalidInputError: they determine no path; says which and why.
        """

    def plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_pose`."""
        return self._plan_through([target], start)

    def _plan_through(self, poses: Sequence[Pose], start: Array) -> Trajectory:
        return self.plan_path(self.path(self.path_kinematics.pose(start), poses), start)
