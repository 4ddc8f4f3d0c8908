"""Limits along a blended path whose motions have different limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import ToolLimits
from robots_planning.trajectory_generators.base import LIMIT_MARGIN

STANDSTILL = 1e-12  # m and rad per unit of s; at rest the path has no direction


@dataclass(frozen=True, eq=False)
class SectionLimits:
    """Limits of one motion of a chain.

    Attributes:
        speed_fraction: Of the axes' velocity limits.
        acceleration_fraction: Of the axes' acceleration limits.
        tool_velocity: Of the tool, (2,), m/s and rad/s; infinite for a joint motion.
        tool_acceleration: (2,), m/s^2 and rad/s^2, along and across its path each.
        tool: Position of the tool centre point in tool0, (3,) m, whose limits these are.
    """

    speed_fraction: float
    acceleration_fraction: float
    tool_velocity: Array
    tool_acceleration: Array
    tool: Array


def chain_limits(
    robot: BaseRobotModel,
    path: JointPath,
    corners: Array,
    sections: Sequence[SectionLimits],
) -> ToolLimits:
    """Limits along a chain's path, for quantities that are divided by the local limit: all bounds are 1.

    Args:
        robot: The robot.
        path: The blended path.
        corners: Values of s at which one motion ends and the next begins, (k - 1,) for k sections.
        sections: Limits of each motion.
    """
    axes = robot.axes_data
    n = robot.num_axes
    velocity, acceleration = (
        np.array([factor * limit * (1.0 - LIMIT_MARGIN) for factor in factors])
        for factors, limit in (
            ([section.speed_fraction for section in sections], axes.velocity),
            ([section.acceleration_fraction for section in sections], axes.acceleration),
        )
    )
    tool_velocity = np.array([section.tool_velocity for section in sections])
    tool_acceleration = np.array([section.tool_acceleration for section in sections])
    tools = np.array([section.tool for section in sections])

    def derivatives(s: Array) -> tuple[Array, Array]:
        section = np.searchsorted(corners, s, side='right')
        q, q_s, q_ss = path.evaluate(s)
        x_s, x_ss = tool_derivatives(robot, tools[section], q, q_s, q_ss)
        still = np.zeros((len(s), n + 2))
        rate, along, across = _travel(x_s, x_ss)
        first = [np.abs(q_s) / velocity[section], rate / tool_velocity[section]]
        second = [still]
        first += [q_s / acceleration[section], rate / tool_acceleration[section], np.zeros((len(s), 2))]
        second += [q_ss / acceleration[section]]
        second += [part / tool_acceleration[section] for part in (along, across)]
        return np.concatenate(first, axis=1), np.concatenate(second, axis=1)

    # Speeds come first, with free accelerations; then accelerations, with free speeds.
    free, bound = np.full(n + 2, np.inf), np.ones(n + 2)
    return ToolLimits(
        derivatives,
        np.concatenate([bound, np.full(n + 4, np.inf)]),
        np.concatenate([free, np.ones(n + 4)]),
    )


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


def _travel(x_s: Array, x_ss: Array) -> tuple[Array, Array, Array]:
    """Rates of arc length and angle over s, their derivatives, and the normal parts of x'', (m, 2) each."""
    rate, along, across = (np.empty((len(x_s), 2)) for _ in range(3))
    for column, part in enumerate((slice(0, 3), slice(3, 6))):
        first, second = x_s[:, part], x_ss[:, part]
        rate[:, column] = np.linalg.norm(first, axis=1)
        direction = first / np.maximum(rate[:, column], STANDSTILL)[:, None]
        along[:, column] = np.einsum('mi,mi->m', direction, second)
        across[:, column] = np.linalg.norm(second - along[:, column, None] * direction, axis=1)
    return rate, along, across
