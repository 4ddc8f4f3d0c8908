"""Motions in messages: the targets of commands, and trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from builtin_interfaces.msg import Time

from robots_core.base_frames import BASE_FRAME, frame_in_base
from robots_core.pose import Pose
from robots_core.ros.joint_trajectories import SerializedTrajectory, serialize_points
from robots_core.ros.messages import NANOSECONDS, joint_values, pose_in_base
from robots_core.validation import Array
from robots_planning.motion_kinds import MotionKind

if TYPE_CHECKING:
    from robots_planning.trajectory import Trajectory


def target_of(
    kind: MotionKind, message: Any, joints: Sequence[str], base_link: Pose
) -> Array | Pose | tuple[Pose, ...]:
    """Joint positions (n,), a pose of the tool or several, in the base.

    Raises:
        InvalidInputError: missing joints, an unknown frame, or values that are not valid.
    """
    if kind.target == 'joints':
        return joint_values(message.name, message.position, joints, kind.topic)
    if kind.target == 'pose':
        return pose_in_base(message.header.frame_id, message.pose, base_link)
    frame_in_base(message.header.frame_id, base_link)  # which it must be in as a whole too
    return tuple(pose_in_base(pose.header.frame_id, pose.pose, base_link) for pose in message.poses)


def trajectory_from_message(message: SerializedTrajectory, names: Sequence[str]) -> tuple[Trajectory, float]:
    """The trajectory of a message, joints matched by name, and where it continues from another, s.

    That is the time of its first point; 0 if it does not continue. Above 0 the trajectory takes the place of
    the running motion and counts time as that one does. Below 0 it carries on the last motion and counts time
    from that one's end.

    Raises:
        InvalidInputError: missing joints, points without velocity or acceleration, or values that make
            no trajectory.
    """
    from robots_planning.trajectory import Trajectory  # noqa: PLC0415  # loads the compiler

    times, rows = message.points(names, 'joint_trajectory')
    return Trajectory((times - times[0]) / NANOSECONDS, *rows), int(times[0]) / NANOSECONDS


def trajectory_message(
    trajectory: Trajectory, names: Sequence[str], stamp: Time, *, join_time: float = 0.0
) -> bytes:
    """Inverse of `trajectory_from_message`, serialized; stamped with the command's id."""
    return serialize_points(names, stamp, BASE_FRAME, *trajectory.points_of_message(join_time))
