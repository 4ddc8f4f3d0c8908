"""SettingsPublisher: publishes on `motion_settings` what holds for the next motion."""

from collections.abc import Callable, Iterable

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.parameter import Parameter

from robots_core.ros.messages import diagnostic_status
from robots_core.ros.qos import STATE
from robots_planning.motion_settings import DESCRIPTIONS, MotionSettings, settings_as_text

TOPIC = 'motion_settings'


class SettingsPublisher:
    """Publishes the modal settings when it begins and whenever they change.

    A command follows the change that it is meant for, so the settings of a recorded command are those that
    were published last before it.

    Args:
        node: Whose parameters they are.
        settings: The settings now.
        robot_name: Of the robot.
    """

    def __init__(self, node: Node, settings: Callable[[], MotionSettings], robot_name: str) -> None:
        self._settings, self._robot_name = settings, robot_name
        self._publisher = node.create_publisher(DiagnosticStatus, TOPIC, STATE)
        node.add_post_set_parameters_callback(self._on_change)
        self._publish()

    def _on_change(self, parameters: Iterable[Parameter]) -> None:
        if any(parameter.name in DESCRIPTIONS for parameter in parameters):
            self._publish()

    def _publish(self) -> None:
        message = diagnostic_status('motion settings', '', hardware_id=self._robot_name)
        texts = settings_as_text(self._settings())
        message.values = [KeyValue(key=name, value=text) for name, text in texts.items()]
        self._publisher.publish(message)
