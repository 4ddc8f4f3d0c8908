"""visualizer_node: the robot moves in a browser page; its description and frames go out."""

from functools import partial
from importlib import import_module
from typing import Any, Final

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from robots_core.blocks.visualizer import Visualizer
from robots_core.nodes.transforms import LinkTransforms
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.ros.messages import joint_values
from robots_core.ros.qos import COMMAND, SENSOR, STATE
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.run import run

MAX_RATE = 100.0  # Hz


class VisualizerNode(RobotNode):
    """Shows `joint_states` in a browser page and publishes `robot_description`, latched.

    Shows the obstacles and attached objects of a scene too, from its file and from `collision_objects`.
    Nothing is drawn while no browser shows the page. Where tf2_msgs is installed, the links' transforms are
    published on /tf too.
    """

    takes_part = False  # a display does not hold time

    def __init__(self, **options: Any) -> None:
        super().__init__('visualizer_node', **options)
        host = self.parameter(
            'host', '127.0.0.1', "the page's network address; 0.0.0.0 for the whole network"
        )
        port = self.parameter('port', 8080, 'first port to try; 0 lets the system choose')
        rate = self.parameter('rate', 30.0, "highest rate of the page's updates, Hz", bounds=(0.1, MAX_RATE))
        self._visualizer = Visualizer(self.robot, host=host, port=port)
        self._scene = WatchedScene(self, self._visualizer.show_scene)
        self._transforms = self._make_transforms()
        self._description = self.create_publisher(String, 'robot_description', STATE)
        self._description.publish(String(data=self.robot.description))
        # The page is for people: it keeps wall-clock time even where the suite runs on simulated time.
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.poll(JointState, 'joint_states', self._update, SENSOR, rate=rate, clock=clock)
        self.journal.info(f'the robot is at {self.url}')
        self.ready(url=self.url)

    @property
    def url(self) -> str:
        """Address of the page."""
        return self._visualizer.url

    def _make_transforms(self) -> LinkTransforms | None:
        try:
            self._tf_message = import_module('tf2_msgs.msg').TFMessage
        except ImportError:
            return None
        self._tf = self.create_publisher(self._tf_message, '/tf', COMMAND)
        namespace = self.get_namespace().strip('/')
        return LinkTransforms(self.robot, prefix=f'{namespace}/' if namespace else '')

    def _update(self, message: JointState) -> None:
        q = joint_values(message.name, message.position, self.robot.axes_data.names, 'joint_states')
        self._visualizer.follow(q)
        if self._transforms is not None:
            transforms = self._transforms.messages(message.header.stamp, q)
            self._tf.publish(self._tf_message(transforms=transforms))
        self.ready(url=self.url)

    def destroy_node(self) -> None:
        """End the page with the node."""
        self._visualizer.close()
        super().destroy_node()


main: Final = partial(run, VisualizerNode)
