"""The speeds of a tool centre point on a trajectory, each part by the tool that moves on it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory
from robots_planning.verification.limit_use import LimitUse

SAMPLE_PERIOD = 4e-3  # s, the controller's


@dataclass(frozen=True, eq=False)
class ToolSection:
    """Limits of a tool centre point on a part of a trajectory.

    Attributes:
        until: The end of the part, s; it begins where the one before ends.
        tool: Position of the tool centre point in tool0, (3,) m.
        speed: Its highest speed, m/s; infinite for none.
        rotation_speed: Highest angular speed, rad/s; infinite for none.
    """

    until: float
    tool: Array
    speed: float
    rotation_speed: float


def tool_speeds(
    trajectory: Trajectory, robot: BaseRobotModel, sections: Sequence[ToolSection]
) -> dict[str, LimitUse]:
    """The highest use of each speed limit, by quantity; nothing where none is limited."""
    worst: dict[str, LimitUse] = {}
    begin = 0.0
    for section in sections:
        limits = (('speed', section.speed, 'm/s'), ('angular speed', section.rotation_speed, 'rad/s'))
        if np.isfinite([limit for _, limit, _ in limits]).any():
            count = max(4, int(np.ceil((section.until - begin) / SAMPLE_PERIOD)))
            # At its ends, where the limits of two parts meet, both hold.
            times = np.linspace(begin, section.until, count + 1)
            speeds = _speeds(trajectory, robot, section.tool, times)
            for values, (quantity, limit, unit) in zip(speeds, limits, strict=True):
                row = int(np.argmax(values))
                ratio, value = float(values[row]) / limit, float(values[row])
                if quantity not in worst or ratio > worst[quantity].ratio:
                    worst[quantity] = LimitUse(
                        quantity, ratio, 'the tool', float(times[row]), value, limit, unit
                    )
        begin = section.until
    return worst


def _speeds(trajectory: Trajectory, robot: BaseRobotModel, tool: Array, times: Array) -> tuple[Array, Array]:
    """Speed (m/s) and angular speed (rad/s) of a tool at times (m,), each (m,)."""
    q, q_dot, _ = trajectory.sample(times)
    twists = np.array([robot.jacobian(row) @ rate for row, rate in zip(q, q_dot, strict=True)])
    arms = robot.tool_poses(q)[1] @ tool
    velocity = twists[:, :3] + np.cross(twists[:, 3:], arms)
    return np.linalg.norm(velocity, axis=1), np.linalg.norm(twists[:, 3:], axis=1)
