"""The target of a motion in the message of its command."""

from collections.abc import Sequence
from typing import Any

from robots_core.base_frames import frame_in_base
from robots_core.pose import Pose
from robots_core.ros.messages import joint_values, pose_in_base
from robots_core.validation import Array
from robots_planning.motion_kinds import MotionKind


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
