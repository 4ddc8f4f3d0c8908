"""How a tool travels along a path: lengths and angles over the path coordinate."""

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

STANDSTILL = 1e-12  # m and rad per unit of s; at rest the path has no direction


def tool_derivatives(
    robot: BaseRobotModel, tools: Array, q: Array, q_s: Array, q_ss: Array
) -> tuple[Array, Array]:
    """First and second derivative of the tool's pose over s, (m, 6) each: linear, angular; base frame.

    The tool centre point has a position in tool0 of its own at each s, `tools` (m, 3).
    """
    first, second = np.empty((len(q), 6)), np.empty((len(q), 6))
    for row, (position, rate, change) in enumerate(zip(q, q_s, q_ss, strict=True)):
        J = robot.jacobian(position)
        first[row] = J @ rate
        second[row] = J @ change + robot.jacobian_der(position, rate) @ rate
    if tools.any():
        frames = (robot.direct_kinematics(position)[1] for position in q)
        arm = np.array([T @ tool for T, tool in zip(frames, tools, strict=True)])
        turning, rising = first[:, 3:], second[:, 3:]
        swing = np.cross(turning, arm)
        first[:, :3] += swing
        second[:, :3] += np.cross(rising, arm) + np.cross(turning, swing)
    return first, second


def travel(x_s: Array, x_ss: Array) -> tuple[Array, Array, Array]:
    """Rates of arc length and angle over s, their derivatives, and the normal parts of x'', (m, 2) each.

    With x' = |x'| t: |x'|' = t x'', and across the path x'' - (t x'') t.

    Args:
        x_s: First derivative of the tool's pose, (m, 6): linear, then angular.
        x_ss: Second derivative, (m, 6).
    """
    rate, along, across = (np.empty((len(x_s), 2)) for _ in range(3))
    for column, part in enumerate((slice(0, 3), slice(3, 6))):
        first, second = x_s[:, part], x_ss[:, part]
        rate[:, column] = np.linalg.norm(first, axis=1)
        direction = first / np.maximum(rate[:, column], STANDSTILL)[:, None]
        along[:, column] = np.einsum('mi,mi->m', direction, second)
        across[:, column] = np.linalg.norm(second - along[:, column, None] * direction, axis=1)
    return rate, along, across
