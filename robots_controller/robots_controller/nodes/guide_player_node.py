"""guide_player_node: plays what guided or jogged a robot, when a program hands its robot over."""

import math
from functools import partial
from typing import Any, Final

from std_msgs.msg import String

from robots_controller.cell.guide_recording import GuideRecording, GuideReplay, read_guide_recording
from robots_core.blocks.following.guide import Guide
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import message_class
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run


class GuidePlayerNode(RobotNode):
    """Publishes a recording's guiding messages from the first SENSOR or PERSON of `guide` on.

    Their stamps are on the node's clock.
    """

    diagnostics_group = 'program'
    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('guide_player_node', **options)
        path = self.parameter('references', '', 'bag of what guides or jogs the robot')
        cabin = self.parameter('cabin', '', 'cabin (YAML): what moves it is played, joy and vehicle_imu')
        if path:
            names, base = self.robot.axes_data.names, self.robot.base_link
            self._open(read_guide_recording(path, names, base_link=base, cabin=bool(cabin)))
        else:
            self.ready('ready; parameter references is empty, nothing is played')

    def _open(self, recording: GuideRecording) -> None:
        self._replay = GuideReplay(recording)
        self._message_publishers = {
            topic: make_publisher(self, message_class(type_name), topic)
            for topic, type_name in recording.types.items()
        }
        self._timer = self.create_timer(1.0, self._play, autostart=False)
        subscribe(self, String, 'guide', self._on_guide)
        self.ready(messages=len(recording.messages))

    def _on_guide(self, message: String) -> None:
        try:
            self._replay.hand_over(Guide(message.data), self._nanoseconds())
        finally:
            self._play()

    def _nanoseconds(self) -> int:
        return int(self.get_clock().now().nanoseconds)

    def _play(self) -> None:
        now = self._nanoseconds()
        for message in self._replay.due(now):
            self._message_publishers[message.topic].publish(message.data)
        following = self._replay.next_time
        if following == math.inf:
            self._timer.cancel()
        else:
            self._timer.timer_period_ns = int(following) - now
            self._timer.reset()


main: Final = partial(run, GuidePlayerNode)
