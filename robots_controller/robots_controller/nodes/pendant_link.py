"""PendantLink: the operator's page as topics and services of the cell."""

from __future__ import annotations

from typing import Final

import numpy as np
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64

from robots_controller.client.program_client import set_parameters
from robots_controller.io.io_image import Channel
from robots_controller.nodes.program_link import ProgramLink
from robots_controller.pendant.jog_command import JogFrame
from robots_core.operating_modes import OperatingMode
from robots_core.ros.messages import doubles, twist_stamped_message
from robots_core.ros.qos import COMMAND, STATE, STREAM
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import Array

PATIENCE: Final = 10.0  # s
STOPS: Final = ('lua_program_node/stop', 'controller_node/stop')


class PendantLink(ProgramLink):
    """See `PendantPort`; safe from any thread.

    Args:
        node: The node to publish and to call from; another thread spins it.
    """

    def __init__(self, node: RobotNode) -> None:
        super().__init__(node, PATIENCE)
        self._node = node
        self._names = list(node.robot.axes_data.names)
        self._twists = node.create_publisher(TwistStamped, 'teach_twist', STREAM)
        self._joints = node.create_publisher(JointState, 'teach_joints', STREAM)
        self._holds = node.create_publisher(Bool, 'hold_to_run', COMMAND)
        self._overrides = node.create_publisher(Float64, 'override', STATE)
        self._services.prepare(STOPS)

    def jog_axes(self, velocity: Array) -> None:
        """See `PendantPort`."""
        message = JointState(name=self._names, velocity=doubles(velocity))
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._joints.publish(message)

    def jog_tool(self, twist: Array, frame: JogFrame) -> None:
        """See `PendantPort`."""
        message = twist_stamped_message(self._node.get_clock().now().to_msg(), np.asarray(twist))
        message.header.frame_id = frame
        self._twists.publish(message)

    def hold_run(self, *, held: bool) -> None:
        """See `PendantPort`."""
        self._holds.publish(Bool(data=held))

    def set_override(self, value: float) -> None:
        """See `PendantPort`."""
        self._overrides.publish(Float64(data=float(value)))

    def stop(self) -> None:
        """See `PendantPort`; both nodes are asked, whatever else does not answer."""
        for service in STOPS:
            self._services.send(service)

    def set_mode(self, mode: OperatingMode) -> None:
        """See `PendantPort`."""
        set_parameters(self._services, 'controller_node', operating_mode=mode.value)

    def force(self, channel: Channel, value: float | None) -> None:
        """See `PendantPort`."""
        if value is None:
            self._io.release(channel.name)
        else:
            self._io.force(channel.name, bool(value) if channel.kind == 'digital' else float(value))
