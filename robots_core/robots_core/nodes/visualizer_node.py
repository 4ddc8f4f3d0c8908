"""visualizer_node: the robot moves in a browser page."""

from functools import partial
from typing import Any, Final

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from sensor_msgs.msg import JointState

from robots_core.blocks.visualizer import Visualizer
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.ros.messages import joint_values
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import PORTS, RobotNode
from robots_core.ros.running.run import run
from robots_core.ros.timed_node import SELDOM

MAX_RATE = 100.0  # Hz


class VisualizerNode(RobotNode):
    """Shows `joint_states` in a browser page.

    Shows the obstacles and attached objects of a scene too, from its file and from `collision_objects`.
    Positions on `ghost` show the robot there too, as a ghost, until a message without any.
    Nothing is drawn while no browser shows the page.
    """

    diagnostics_group = 'surroundings'
    heartbeat_period = SELDOM

    def __init__(self, **options: Any) -> None:
        super().__init__('visualizer_node', **options)
        host = self.parameter(
            'host', '127.0.0.1', "the page's network address; 0.0.0.0 for the whole network"
        )
        port = self.parameter('port', 8080, 'first port to try; 0 lets the system choose', bounds=PORTS)
        rate = self.parameter('rate', 30.0, "highest rate of the page's updates, Hz", bounds=(0.1, MAX_RATE))
        self._visualizer = Visualizer(self.robot, host=host, port=port)
        self.closing.callback(self._visualizer.close)
        self._scene = WatchedScene(self, self._visualizer.show_scene)
        subscribe(self, JointState, 'ghost', self._show_ghost)
        # The page is for people: it keeps wall-clock time even where the suite runs on simulated time.
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.poll(JointState, 'joint_states', self._update, rate=rate, clock=clock, again=lambda _: True)
        self.journal.info(f'the robot is at {self.url}')
        self.ready(url=self.url)

    @property
    def url(self) -> str:
        """Address of the page."""
        return self._visualizer.url

    def _update(self, message: JointState) -> None:
        names = self.robot.axes_data.names
        self._visualizer.follow(joint_values(message.name, message.position, names, 'joint_states'))
        self.ready(url=self.url)

    def _show_ghost(self, message: JointState) -> None:
        names = self.robot.axes_data.names
        q = joint_values(message.name, message.position, names, 'ghost') if message.position else None
        self._visualizer.show_ghost(q)


main: Final = partial(run, VisualizerNode)
