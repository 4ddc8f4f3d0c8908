"""Limits along a blended path whose motions have different limits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import ToolLimits
from robots_planning.timing.tool_travel import tool_derivatives, travel
from robots_planning.trajectory_generators.base import LIMIT_MARGIN


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
        rate, along, across = travel(x_s, x_ss)
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
