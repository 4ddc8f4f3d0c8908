"""Limits of the tool along a path, and along a blended path whose motions have different limits."""

from collections.abc import Sequence

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import ToolLimits
from robots_planning.trajectory_generators.base import LIMIT_MARGIN

STANDSTILL = 1e-12  # m and rad per unit of s; at rest the path has no direction


def path_limits(
    robot: BaseRobotModel,
    joint_path: JointPath,
    tool_path: CartesianPath,
    tool: Array,
    turning_tool: Array | None,
) -> ToolLimits | None:
    """Limits along a path; the tool's tangential and normal accelerations are limited separately.

    Args:
        robot: The robot.
        joint_path: Joint positions over s.
        tool_path: Poses of the tool over the same s.
        tool: Highest speed (m/s), acceleration, angular speed (rad/s) and angular acceleration of the tool,
            (4,); infinite for none.
        turning_tool: Position in tool0, (3,) m, of a tool that turns as the arm must, whose speeds are those
            of the axes' path; None for a tool that has the orientations of its own path.
    """
    if np.isinf(tool).all():
        return None

    def derivatives(s: Array) -> tuple[Array, Array]:
        if turning_tool is None:
            samples = tool_path.sample(s)
            x_s, x_ss = samples.x_s, samples.x_ss
        else:
            tools = np.tile(turning_tool, (len(s), 1))
            x_s, x_ss = _tool_derivatives(robot, tools, *joint_path.evaluate(s))
        rate, along, across = _travel(x_s, x_ss)
        return np.hstack([rate, np.zeros_like(rate)]), np.hstack([along, across])

    speed, acceleration = tool[::2], tool[1::2]
    return ToolLimits(derivatives, np.append(speed, [np.inf, np.inf]), np.append(acceleration, acceleration))


def chain_limits(
    robot: BaseRobotModel,
    path: JointPath,
    corners: Array,
    sections: Sequence[tuple[MotionSettings, bool]],
) -> ToolLimits:
    """Limits along a chain's path, for quantities that are divided by the local limit: all bounds are 1.

    Args:
        robot: The robot.
        path: The blended path.
        corners: Values of s at which one motion ends and the next begins, (k - 1,) for k sections.
        sections: The settings of each motion, and whether the limits of the tool hold in it.
    """
    axes = robot.axes_data
    n = robot.num_axes
    settings, inside = [setting for setting, _ in sections], 1.0 - LIMIT_MARGIN
    velocity = np.array([setting.speed_fraction for setting in settings])[:, None] * axes.velocity * inside
    acceleration = np.array([setting.acceleration_fraction for setting in settings])[:, None]
    acceleration = acceleration * axes.acceleration * inside
    tool_velocity, tool_acceleration = np.full((2, len(settings), 2), np.inf)
    for row, (setting, limited) in enumerate(sections):
        if limited:
            tool_velocity[row] = setting.cartesian_speed, setting.rotation_speed
            tool_acceleration[row] = setting.cartesian_acceleration, setting.rotation_acceleration
    tools = np.array([setting.tool_pose.r for setting in settings])

    def derivatives(s: Array) -> tuple[Array, Array]:
        section = np.searchsorted(corners, s, side='right')
        q, q_s, q_ss = path.evaluate(s)
        x_s, x_ss = _tool_derivatives(robot, tools[section], q, q_s, q_ss)
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


def _tool_derivatives(
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
