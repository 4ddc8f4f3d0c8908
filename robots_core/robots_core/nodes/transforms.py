"""Transforms of a robot's links, as they travel on /tf."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from lxml import etree

from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class LinkTransforms:
    """Poses of the links behind a robot's axes, and of tool0, in its base link.

    Args:
        robot: The robot; its description has the links' names.
        prefix: Put before every frame name, so that two robots can share /tf.
    """

    def __init__(self, robot: BaseRobotModel, *, prefix: str = '') -> None:
        self._robot = robot
        root = etree.fromstring(robot.description.encode())
        child = {joint.get('name'): joint.find('child').get('link') for joint in root.findall('joint')}
        links = [link.get('name') for link in root.findall('link')]
        base = next(link for link in links if link not in child.values())
        self._base = prefix + base
        self._links = [prefix + child[name] for name in robot.axes_data.names]
        self._tool = f'{prefix}tool0'

    def messages(self, stamp: Time, q: Array) -> list[TransformStamped]:
        """The transforms at joint positions `q`, (n,) rad (m).

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        r, T = self._robot.kinematic_model.frame_axes(q)
        poses = [Pose(*frame) for frame in zip(r, T, strict=True)]
        messages = [self._message(stamp, *item) for item in zip(self._links, poses, strict=True)]
        return [*messages, self._message(stamp, self._tool, Pose(*self._robot.direct_kinematics(q)))]

    def _message(self, stamp: Time, child: str, pose: Pose) -> TransformStamped:
        message = TransformStamped(child_frame_id=child)
        message.header.stamp = stamp
        message.header.frame_id = self._base
        translation, rotation = message.transform.translation, message.transform.rotation
        translation.x, translation.y, translation.z = map(float, pose.r)
        rotation.x, rotation.y, rotation.z, rotation.w = map(float, pose.quaternion())
        return message
