"""DynamicProgrammingTiming: time-optimal motion along a path of the tool."""

from __future__ import annotations

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import TimeOptimalTiming, ToolLimits
from robots_planning.trajectory import Trajectory

STANDSTILL = 1e-12  # m and rad per unit of s; at rest the path has no direction


class DynamicProgrammingTiming:
    """The fastest motion along a path that keeps the limits of axes, torques and tool.

    The tool's tangential and normal accelerations are limited separately.

    Args:
        robot: The robot.
        velocity: Of the axes, (n,), rad/s (m/s).
        acceleration: rad/s^2 (m/s^2).
        effort: Torques, N m (N); None for no limits.
        tool_velocity: Of the tool, (2,), m/s and rad/s; infinite for no limit.
        tool_acceleration: (2,), m/s^2 and rad/s^2; infinite for no limit.
        jerk: Of the axes, rad/s^3 (m/s^3); None for no limits.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        velocity: Array,
        acceleration: Array,
        effort: Array | None,
        *,
        tool_velocity: Array,
        tool_acceleration: Array,
        jerk: Array | None = None,
    ) -> None:
        self._timing = TimeOptimalTiming(robot, velocity, acceleration, effort, jerk=jerk)
        self._tool_velocity = np.concatenate([tool_velocity, [np.inf, np.inf]])
        self._tool_acceleration = np.concatenate([tool_acceleration, tool_acceleration])

    def trajectory(
        self, joint_path: JointPath, tool_path: CartesianPath, longest: float = np.inf
    ) -> Trajectory:
        """The timed motion along a path; see `PathTiming`.

        Raises:
            PlanningError: the robot cannot hold itself against gravity somewhere on the path.
            TooSlowError: it takes longer than `longest`, s.
        """
        limits = None
        if not np.isinf([self._tool_velocity, self._tool_acceleration]).all():
            limits = ToolLimits(lambda s: travel(tool_path, s), self._tool_velocity, self._tool_acceleration)
        return self._timing.trajectory(joint_path, limits, longest)


def travel(path: CartesianPath, s: Array) -> tuple[Array, Array]:
    """First and second derivatives over s (m,) of length and angle, and the normal parts, (m, 4) each.

    With x' = |x'| t: |x'|' = t x'', and across the path x'' - (t x'') t.
    """
    samples = path.sample(s)
    first, second = np.zeros((len(s), 4)), np.zeros((len(s), 4))
    for column, part in enumerate((slice(0, 3), slice(3, 6))):
        x_s, x_ss = samples.x_s[:, part], samples.x_ss[:, part]
        rate = np.linalg.norm(x_s, axis=1)
        direction = x_s / np.maximum(rate, STANDSTILL)[:, None]
        along = np.einsum('mi,mi->m', direction, x_ss)
        first[:, column], second[:, column] = rate, along
        second[:, 2 + column] = np.linalg.norm(x_ss - along[:, None] * direction, axis=1)
    return first, second
