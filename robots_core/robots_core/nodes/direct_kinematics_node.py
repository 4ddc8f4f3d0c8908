"""direct_kinematics_node: joint positions in, pose of the tool out."""

from functools import partial
from typing import Any, Final

from geometry_msgs.msg import PoseStamped
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from robots_core.blocks.direct_kinematics import DirectKinematics
from robots_core.nodes.shared_parameters import NO_TOOL, pose_from_parameter
from robots_core.pose import Pose
from robots_core.ros.messages import BUILD, ENCAPSULATION_SIZE, STAMP_END, joint_values
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.timed_node import SELDOM

MAX_RATE = 1000.0  # Hz


class DirectKinematicsNode(RobotNode):
    """Publishes `tcp_pose` for the newest `joint_states`, at most `rate` times a second."""

    heartbeat_period = SELDOM

    def __init__(self, **options: Any) -> None:
        super().__init__('direct_kinematics_node', **options)
        tool = self.parameter(
            'tool', NO_TOOL, 'tool in tool0: x y z (m), quaternion x y z w', read=pose_from_parameter
        )
        rate = self.parameter('rate', 50.0, 'highest publishing rate, Hz', bounds=(0.1, MAX_RATE))
        self._kinematics = DirectKinematics(self.robot, tool=tool)
        self._kinematics.forward(self.robot.home)  # a ready node has loaded what it needs
        self._publisher = make_publisher(self, PoseStamped, 'tcp_pose')
        self._pose = b''  # serialized
        self.poll(JointState, 'joint_states', self._publish, rate=rate, again=self._publish_again)
        self.on_change('tool', self._use_tool)
        self.ready()

    def _publish(self, message: JointState) -> None:
        q = joint_values(message.name, message.position, self.robot.axes_data.names, 'joint_states')
        pose = BUILD.pose_stamped(message.header.stamp, self._kinematics.forward(q))
        self._pose = serialize_message(pose)
        self._publisher.publish(self._pose)
        self.ready()

    def _publish_again(self, stamp: bytes) -> bool:
        if self._pose:
            self._pose = self._pose[:ENCAPSULATION_SIZE] + stamp + self._pose[STAMP_END:]
            self._publisher.publish(self._pose)
        return bool(self._pose)

    def _use_tool(self, tool: Pose) -> None:
        self._kinematics = DirectKinematics(self.robot, tool=tool)
        self._pose = b''


main: Final = partial(run, DirectKinematicsNode)
