"""PosesGenerator: the base class of motions through several poses."""

from collections.abc import Sequence
from typing import Any, Self

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.cartesian_generator import CartesianGenerator
from robots_planning.trajectory_generators.trajectory_generator import Target


class PosesGenerator(CartesianGenerator):
    """The tool centre point follows a curve that several poses determine."""

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """See `TrajectoryGenerator.from_settings`; the algorithm is that of `cartesian_planner`."""
        return super().from_settings(robot, settings, planner=settings.cartesian_planner, **options)

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
