"""trajectory_msgs/JointTrajectory to a Trajectory and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_core.base_frames import BASE_FRAME
from robots_core.ros.joint_trajectories import complete_points
from robots_core.ros.messages import NANOSECONDS, doubles, nanoseconds, seconds
from robots_planning.trajectory import Trajectory


def trajectory_from_message(message: JointTrajectory, names: Sequence[str]) -> Trajectory:
    """The trajectory of a message, joints matched by name.

    A first point at another time than 0 means that the trajectory continues from another (see `join_time`).

    Raises:
        InvalidInputError: missing joints, points without velocity or acceleration, or values that make
            no trajectory.
    """
    _, rows = complete_points(message, names, 'joint_trajectory')
    stamps = np.array([nanoseconds(point.time_from_start) for point in message.points])
    return Trajectory((stamps - stamps[0]) / NANOSECONDS, *rows)


def join_time(message: JointTrajectory) -> float:
    """Where a message's trajectory continues from another, s; 0 if it does not.

    It is the time of its first point. Above 0 the trajectory takes the place of the running motion and counts
    time as that one does. Below 0 it carries on the last motion and counts time from that one's end.
    """
    return seconds(message.points[0].time_from_start)


def trajectory_message(
    trajectory: Trajectory, names: list[str], stamp: Time, *, join_time: float = 0.0
) -> JointTrajectory:
    """A trajectory as trajectory_msgs/JointTrajectory, stamped with its command's id.

    Args:
        trajectory: What to do.
        names: The joints.
        stamp: The command's id.
        join_time: Where the trajectory continues from another, s; see the function of this name.
    """
    message = JointTrajectory(joint_names=names)
    message.header.stamp = stamp
    message.header.frame_id = BASE_FRAME
    rows = zip(
        (np.round(trajectory.time * NANOSECONDS) + round(join_time * NANOSECONDS)).astype(np.int64).tolist(),
        trajectory.position,
        trajectory.velocity,
        trajectory.acceleration,
        strict=True,
    )
    points = []
    for since, q, q_dot, q_ddot in rows:
        point = JointTrajectoryPoint(
            positions=doubles(q), velocities=doubles(q_dot), accelerations=doubles(q_ddot)
        )
        point.time_from_start.sec, point.time_from_start.nanosec = divmod(since, NANOSECONDS)
        points.append(point)
    message.points = points
    return message
