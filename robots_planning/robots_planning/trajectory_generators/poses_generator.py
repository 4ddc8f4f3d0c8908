"""PosesGenerator: what all motions through several poses have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.cartesian_generator import CartesianGenerator


class PosesGenerator(CartesianGenerator):
    """The tool centre point follows a curve that several poses determine."""

    def generate(self, q_start: ArrayLike, target: Pose | Sequence[Pose] | ArrayLike) -> Trajectory:
        """Plan a motion from rest to rest.

        Args:
            q_start: Joint positions to start from, (n,), rad (m).
            target: Poses of the tool centre point in the base frame, in the order of the motion; the start's
                is not among them.

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

    def _plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        return self._plan_through([target], start)

    def _plan_through(self, poses: Sequence[Pose], start: Array) -> Trajectory:
        return self.plan_path(self.path(self.path_kinematics.pose(start), poses), start)
