"""trajectory_msgs/JointTrajectory to a Trajectory and back."""

from __future__ import annotations

from collections.abc import Sequence

from builtin_interfaces.msg import Time

from robots_core.base_frames import BASE_FRAME
from robots_core.ros.messages import NANOSECONDS
from robots_core.ros.streams.serialized_trajectory import SerializedTrajectory, serialize_points
from robots_planning.trajectory import Trajectory


def trajectory_from_message(message: SerializedTrajectory, names: Sequence[str]) -> tuple[Trajectory, float]:
    """The trajectory of a message, joints matched by name, and where it continues from another, s.

    That is the time of its first point; 0 if it does not continue. Above 0 the trajectory takes the place of
    the running motion and counts time as that one does. Below 0 it carries on the last motion and counts time
    from that one's end.

    Raises:
        InvalidInputError: missing joints, points without velocity or acceleration, or values that make
            no trajectory.
    """
    times, rows = message.points(names, 'joint_trajectory')
    return Trajectory((times - times[0]) / NANOSECONDS, *rows), int(times[0]) / NANOSECONDS


def trajectory_message(
    trajectory: Trajectory, names: Sequence[str], stamp: Time, *, join_time: float = 0.0
) -> bytes:
    """Inverse of `trajectory_from_message`, serialized; stamped with the command's id."""
    return serialize_points(names, stamp, BASE_FRAME, *trajectory.points_of_message(join_time))
