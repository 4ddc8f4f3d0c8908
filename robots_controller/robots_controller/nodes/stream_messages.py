"""One-point trajectory_msgs/JointTrajectory to a StreamPoint."""

from __future__ import annotations

import numpy as np
from trajectory_msgs.msg import JointTrajectory

from robots_controller.control.streamed_reference import StreamPoint
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import NANOSECONDS, joint_indices, nanoseconds
from robots_core.validation import finite_vector


def stream_point_from_message(
    message: JointTrajectory, names: list[str], *, ros_time: int, now: float
) -> StreamPoint:
    """The point of a message, joints matched by name.

    It is due `time_from_start` after the message's stamp, or from now without a stamp, as in ros2_control.
    Velocity and acceleration are zero where they are missing.

    Args:
        message: With one point.
        names: The robot's joints, n of them.
        ros_time: Time on the clock of the message's stamp, ns.
        now: The same instant on the controller's clock, s.

    Raises:
        InvalidInputError: missing joints, arrays of other lengths, or values that are not finite.
    """
    indices = joint_indices(message.joint_names, names, 'joint_trajectory')
    (point,) = message.points
    count = len(message.joint_names)
    rows = []
    for field in ('positions', 'velocities', 'accelerations'):
        row = getattr(point, field)
        if len(row) == 0 and field != 'positions':
            rows.append(np.zeros(len(names)))
        elif len(row) != count:
            raise InvalidInputError(f'the streamed point has {len(row)} {field} for {count} joints')
        else:
            rows.append(finite_vector(row, count, field)[indices])
    ahead = nanoseconds(point.time_from_start)
    if sent := nanoseconds(message.header.stamp):
        ahead += sent - ros_time
    position, velocity, acceleration = rows
    due = (round(now * NANOSECONDS) + ahead) / NANOSECONDS
    return StreamPoint(position, velocity, acceleration, due)
