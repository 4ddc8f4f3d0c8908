"""robot_state_node: the robot's description, and its frames on /tf and /tf_static."""

from collections.abc import Iterable
from functools import partial
from importlib import import_module
from typing import Any, Final

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from robots_core.blocks.link_frames import FramePose, LinkFrames
from robots_core.nodes.shared_parameters import NO_TOOL, pose_from_parameter
from robots_core.pose import Pose
from robots_core.ros.messages import joint_values
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.timed_node import SELDOM

MAX_RATE: Final = 1000.0  # Hz
FRAMES: Final = {'tool': 'tool0', 'work': 'base'}
"""Parents of the frames that parameters place."""


class RobotStateNode(RobotNode):
    """Publishes `robot_description`, latched, and where tf2_msgs is installed `/tf` and `/tf_static`.

    Without tf2_msgs it says so once, and publishes the description alone.
    """

    heartbeat_period = SELDOM

    def __init__(self, **options: Any) -> None:
        super().__init__('robot_state_node', **options)
        rate = self.parameter('rate', 50.0, 'highest rate of /tf, Hz', bounds=(0.1, MAX_RATE))
        self._placed: dict[str, FramePose] = {}
        for name, parent in FRAMES.items():
            text = f'frame {name} in {parent}: x y z (m), quaternion x y z w'
            pose = self.parameter(name, NO_TOOL, text, read=pose_from_parameter)
            self._placed[name] = FramePose(parent, name, pose)
        self._frames = LinkFrames(self.robot.description)
        namespace = self.get_namespace().strip('/')
        self._prefix = f'{namespace}/' if namespace else ''
        self._description = make_publisher(self, String, 'robot_description')
        self._description.publish(String(data=self.robot.description))
        self._tf: Any = None
        try:
            self._message = import_module('tf2_msgs.msg').TFMessage
        except ImportError as error:
            self.ready(f'ready; no transforms: tf2_msgs cannot be imported ({error})')
            self.journal.info(f'no transforms are published: tf2_msgs cannot be imported ({error})')
            return
        self._tf = make_publisher(self, self._message, '/tf')
        self._static = make_publisher(self, self._message, '/tf_static')
        self._publish_static()
        for name in FRAMES:
            self.on_change(name, partial(self._place, name))
        self.poll(JointState, 'joint_states', self._publish, rate=rate)
        self.ready()

    def _publish(self, message: JointState) -> None:
        names = self.robot.axes_data.names
        q = joint_values(message.name, message.position, names, 'joint_states')  # refuses what is not valid
        others = dict(zip(message.name, message.position, strict=True))
        positions = {**others, **dict(zip(names, map(float, q), strict=True))}
        self._tf.publish(self._transforms(message.header.stamp, self._frames.moving(positions)))
        self.ready()

    def _publish_static(self) -> None:
        stamp = self.get_clock().now().to_msg()
        self._static.publish(self._transforms(stamp, (*self._frames.fixed, *self._placed.values())))

    def _transforms(self, stamp: Time, frames: Iterable[FramePose]) -> Any:
        return self._message(transforms=[self._transform(stamp, frame) for frame in frames])

    def _transform(self, stamp: Time, frame: FramePose) -> TransformStamped:
        """A frame seen from its parent; the prefix of both names lets two robots share /tf."""
        message = TransformStamped(child_frame_id=self._prefix + frame.child)
        message.header.stamp, message.header.frame_id = stamp, self._prefix + frame.parent
        translation, rotation = message.transform.translation, message.transform.rotation
        translation.x, translation.y, translation.z = map(float, frame.pose.r)
        rotation.x, rotation.y, rotation.z, rotation.w = map(float, frame.pose.quaternion())
        return message

    def _place(self, name: str, pose: Pose) -> None:
        self._placed[name] = FramePose(FRAMES[name], name, pose)
        self._publish_static()


main: Final = partial(run, RobotStateNode)
