"""Following of a reference pose, period by period, by each of the inverse kinematics blocks."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.following.axis_following import AxisFollowing
from robots_core.blocks.following.following_methods import METHODS
from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.constrained import (
    ConstrainedInverseKinematics,
    braking_deceleration,
)
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import HeldInverseKinematics
from robots_core.blocks.inverse_kinematics.hold import POSE, held_by, weights_of
from robots_core.blocks.inverse_kinematics.redundancy import Redundancy
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, one_of

TOLERANCES: Final = (1e-8, 1e-8)  # m and rad: below what a drive resolves


@dataclass(frozen=True, eq=False)
class FollowedStep:
    """Motion of one period.

    Attributes:
        state: (3, n): positions and velocities at its end, accelerations during it.
        position_error: Distance to the reference at its end, m.
        orientation_error: Angle to the reference at its end, rad.
        slack: Largest violation of a limit, relative to it.
        limits: Descriptions of active limits; empty for methods that do not report them.
    """

    state: Array
    position_error: float
    orientation_error: float
    slack: float = 0.0
    limits: tuple[str, ...] = ()


class PoseFollowing(ABC):
    """Follows a reference pose; from every state that it leads to the robot can brake inside the limits.

    Args:
        robot: The robot.
        dt: Period, s.
        tool: Pose of the tool centre point in tool0, which follows the reference.
        hold: What of the reference is followed, one of HOLDS.
    """

    def __init__(self, robot: BaseRobotModel, dt: float, tool: Pose, hold: str) -> None:
        self.robot, self.dt, self.tool, self.hold = robot, dt, tool, hold
        self._axes = AxisFollowing(robot.axes_data, dt, deceleration=braking_deceleration(robot))

    @abstractmethod
    def follow(self, pose: Pose, twist: Array, q: Array, q_dot: Array) -> FollowedStep:
        """Motion of the next period towards a pose with a twist (6,) at its end, from state q, q_dot (n,).

        Raises:
            UnreachablePoseError: the method finds no solution.
        """

    def begin(self, q: Array) -> None:
        """The robot is guided from joint positions q (n,) on, rad (m)."""
        del q

    def brake(self, q: Array, q_dot: Array) -> Array:
        """State (3, n) after a period of braking."""
        return self._axes.brake(q, q_dot)

    def pose(self, q: Array) -> Pose:
        """Pose of the tool centre point."""
        return self.robot.pose(q) @ self.tool


class ConstrainedFollowing(PoseFollowing):
    """By `ConstrainedInverseKinematics`: inside all limits, torques included, along the reference's path.

    A robot on a sliding axis keeps the posture in which it began, as far as the axis can go in its place.
    """

    def __init__(self, robot: BaseRobotModel, dt: float, tool: Pose, hold: str) -> None:
        super().__init__(robot, dt, tool, hold)
        self._ik = ConstrainedInverseKinematics(
            robot,
            dt,
            tool=tool,
            weights=weights_of(self.hold),
            redundancy=Redundancy.sliding(robot.axes_data, robot.home),
        )

    def begin(self, q: Array) -> None:
        """See `PoseFollowing.begin`."""
        self._ik.prefer(q)

    def follow(self, pose: Pose, twist: Array, q: Array, q_dot: Array) -> FollowedStep:
        """See `PoseFollowing.follow`."""
        step = self._ik.step(pose, q, q_dot, twist)
        limits = tuple(f'{limit.joint} {limit.quantity} {limit.side}' for limit in step.active_limits)
        return FollowedStep(step.values[:3], step.position_error, step.orientation_error, step.slack, limits)


class JointFollowing(PoseFollowing):
    """By joint positions for each pose, which the axes follow independently; torques are not limited.

    Arguments are those of `PoseFollowing`, and what finds joint positions (n,) for a pose of the tool, near
    others.
    """

    def __init__(
        self, robot: BaseRobotModel, dt: float, tool: Pose, hold: str, solve: Callable[[Pose, Array], Array]
    ) -> None:
        super().__init__(robot, dt, tool, hold)
        self._solve = solve
        self._last: Array | None = None

    def follow(self, pose: Pose, twist: Array, q: Array, q_dot: Array) -> FollowedStep:
        """See `PoseFollowing.follow`."""
        del twist
        solution = self._solve(pose, q)
        velocity = np.zeros_like(q) if self._last is None else (solution - self._last) / self.dt
        if (np.abs(velocity) > self.robot.axes_data.velocity).any():  # a jump of the reference
            velocity = np.zeros_like(q)
        self._last = solution
        state = self._axes.step(q, q_dot, solution, velocity)
        return FollowedStep(state, *self.pose(state[0]).distance_to(pose))


def pose_following(
    method: str, robot: BaseRobotModel, dt: float, tool: Pose, hold: str = ''
) -> PoseFollowing:
    """The following by a method, one of METHODS.

    'damped_least_squares' follows the closest pose that it finds; 'analytical' follows whole poses, on the
    branch nearest to the last solution.

    Raises:
        InvalidInputError: no such method, or a `hold` that it does not have.
        NoAnalyticInverseKinematicsError: the robot has no closed form.
    """
    one_of('method', METHODS)(method)
    hold = held_by(robot.num_axes, hold)
    if method == 'constrained':
        return ConstrainedFollowing(robot, dt, tool, hold)
    if method == 'analytical':
        if hold != POSE:
            raise InvalidInputError(
                f"method 'analytical' follows whole poses; for hold = {hold!r} use 'constrained' or "
                f"'damped_least_squares'"
            )
        return JointFollowing(robot, dt, tool, hold, AnalyticalInverseKinematic(robot, tool=tool).solve)
    numerical = (
        DampedLeastSquares(robot, tolerances=TOLERANCES, restarts=0, tool=tool)
        if hold == POSE
        else HeldInverseKinematics(robot, tool=tool, hold=hold, restarts=0)
    )
    # Compiled code is loaded here and not in the first step of a real-time loop.
    numerical.solve(robot.pose(robot.home) @ tool, robot.home)
    return JointFollowing(robot, dt, tool, hold, lambda pose, q: numerical.solve(pose, q).q)
