"""TrajectoryGenerator: what all path-planning blocks have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.errors import InvalidInputError, PlanningError, UnreachablePoseError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive
from robots_planning.trajectory import Trajectory

# Plans stay this much inside the limits, so that rounding and resampling find them inside too.
LIMIT_MARGIN = 1e-4
REST_DURATION = 0.01  # s, of a move without length
END_TOLERANCE = 1e-9  # rad (m); inverse kinematics converges to 1e-10


class TrajectoryGenerator(ABC):
    """One kind of motion: validate the command, plan it, check the plan.

    Args:
        robot: The robot.
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration and jerk limits to use, in (0, 1].

    Raises:
        InvalidInputError: a fraction outside (0, 1].
    """

    accepts_joints: ClassVar[bool] = True

    def __init__(
        self, robot: BaseRobotModel, *, speed_fraction: float = 1.0, acceleration_fraction: float = 1.0
    ) -> None:
        self.robot = robot
        self.speed_fraction = usable_fraction(speed_fraction, 'speed_fraction')
        self.acceleration_fraction = usable_fraction(acceleration_fraction, 'acceleration_fraction')
        axes = robot.axes_data
        self.velocity = axes.velocity * self.speed_fraction * (1.0 - LIMIT_MARGIN)
        self.acceleration = axes.acceleration * self.acceleration_fraction * (1.0 - LIMIT_MARGIN)
        self.jerk = axes.jerk * self.acceleration_fraction * (1.0 - LIMIT_MARGIN)

    @cached_property
    def inverse_kinematics(self) -> DampedLeastSquares:
        """Made when it is first needed."""
        return DampedLeastSquares(self.robot)

    def generate(self, q_start: ArrayLike, target: Pose | ArrayLike) -> Trajectory:
        """Plan a motion from rest to rest.

        Args:
            q_start: Joint positions to start from, (n,), rad (m).
            target: Pose of tool0 in the base frame, or joint positions (n,), rad (m).

        Raises:
            JointLimitError: start or target outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the pose.
            PlanningError: the motion between start and target is impossible; says where and why.
            InvalidInputError: wrong shapes, NaN or infinity, or a kind of target not meant for this motion.
        """
        start = self.robot.axes_data.check_position(q_start, 'q_start')
        if isinstance(target, Pose):
            trajectory = self._plan_to_pose(start, target)
        elif self.accepts_joints:
            trajectory = self._plan_to_joints(start, self.robot.axes_data.check_position(target, 'target'))
        else:
            raise InvalidInputError(
                f'{type(self).__name__} needs a Pose as target, got {type(target).__name__}; '
                'joint targets are for motions in joint space'
            )
        self._check(trajectory, start)
        return trajectory

    @abstractmethod
    def _plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """Plan to a pose; the start is valid."""

    def _plan_to_joints(self, start: Array, target: Array) -> Trajectory:
        """Plan to joint positions; both ends are valid. Only for generators that accept joints."""
        raise NotImplementedError(type(self).__name__)

    def _check(self, trajectory: Trajectory, start: Array) -> None:
        """A plan begins at the commanded start, and both its ends rest."""
        ends = (0, -1)
        moving = max(
            float(np.abs(trajectory.velocity[row]).max() + np.abs(trajectory.acceleration[row]).max())
            for row in ends
        )
        off = float(np.abs(trajectory.position[0] - start).max())
        if moving > 0.0 or off > END_TOLERANCE:
            raise PlanningError(
                f'{type(self).__name__} made a plan that starts {off:.3g} rad off or does not rest at its '
                f'ends ({moving:.3g}); allowed are {END_TOLERANCE:g} and 0',
                start_error=off,
                end_motion=moving,
            )

    def reach(self, pose: Pose, q_start: Array) -> Array:
        """Joint positions (n,) for a pose, in the configuration that the search from `q_start` finds.

        Raises:
            UnreachablePoseError: names how far off the closest posture is.
        """
        result = self.inverse_kinematics.solve(pose, q_start)
        if not result.converged:
            x, y, z = (float(value) for value in pose.r)
            raise UnreachablePoseError(
                f'{self.robot.name} cannot reach position ({x:.4f}, {y:.4f}, {z:.4f}) m with the commanded '
                f'orientation inside its axis limits: the closest posture found is '
                f'{result.position_error * 1e3:.3g} mm and {result.orientation_error:.3g} rad off',
                x=x,
                y=y,
                z=z,
                position_error=result.position_error,
                orientation_error=result.orientation_error,
            )
        return result.q


def usable_fraction(value: float, name: str) -> float:
    """`value` if it is in (0, 1].

    Raises:
        InvalidInputError: outside, NaN or infinite.
    """
    if not positive(value, name) <= 1.0:
        raise InvalidInputError(f'{name} = {value!r} must be in (0, 1]')
    return float(value)


def rest_trajectory(start: Array, target: Array) -> Trajectory:
    """A short trajectory between two points that are the same, or closer than rounding."""
    zero = np.zeros((2, len(start)))
    return Trajectory(np.array([0.0, REST_DURATION]), np.stack([start, target]), zero, zero)
