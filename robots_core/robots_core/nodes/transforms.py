"""Poses of frames as messages on /tf."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped

from robots_core.blocks.link_frames import FramePose


def transform_message(stamp: Time, frame: FramePose, prefix: str = '') -> TransformStamped:
    """A frame seen from its parent.

    Args:
        stamp: When it is there.
        frame: The frame.
        prefix: Put before both names, so that two robots can share /tf.
    """
    message = TransformStamped(child_frame_id=prefix + frame.child)
    message.header.stamp = stamp
    message.header.frame_id = prefix + frame.parent
    translation, rotation = message.transform.translation, message.transform.rotation
    translation.x, translation.y, translation.z = map(float, frame.pose.r)
    rotation.x, rotation.y, rotation.z, rotation.w = map(float, frame.pose.quaternion())
    return message
