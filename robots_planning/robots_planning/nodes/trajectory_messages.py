"""trajectory_msgs/JointTrajectory to a Trajectory and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_core.ros.joint_trajectories import complete_points
from robots_core.ros.messages import doubles, seconds
from robots_planning.trajectory import Trajectory

BASE_FRAME = 'base'


def trajectory_from_message(message: JointTrajectory, names: Sequence[str]) -> Trajectory:
    """The trajectory of a message, joints matched by name.

    A first point later than 0 means that the trajectory goes on from the running one (see `join_time`).

    Raises:
        InvalidInputError: missing joints, points without velocity or acceleration, or values that make
            no trajectory.
    """
    time, rows = complete_points(message, names, 'joint_trajectory')
    return Trajectory(time - join_time(message), *rows)


def join_time(message: JointTrajectory) -> float:
    """Time of the running motion at which a message's trajectory goes on in its place, s; 0 if it does not.

    It is the time of its first point: the trajectory counts time as the motion does whose place it takes.
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
        join_time: Where the trajectory goes on from the running one, s of that one's time; 0: it does not.
    """
    message = JointTrajectory(joint_names=names)
    message.header.stamp = stamp
    message.header.frame_id = BASE_FRAME
    rows = zip(
        np.round((trajectory.time + join_time) * 1e9).astype(np.int64).tolist(),
        trajectory.position,
        trajectory.velocity,
        trajectory.acceleration,
        strict=True,
    )
    points = []
    for nanoseconds, q, q_dot, q_ddot in rows:
        point = JointTrajectoryPoint(
            positions=doubles(q), velocities=doubles(q_dot), accelerations=doubles(q_ddot)
        )
        point.time_from_start.sec, point.time_from_start.nanosec = divmod(nanoseconds, 1_000_000_000)
        points.append(point)
    message.points = points
    return message
