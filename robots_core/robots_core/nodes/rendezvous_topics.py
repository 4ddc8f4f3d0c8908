"""RendezvousTopics: the bodies in orbit that drive_node moves, as topics."""

from typing import Any

import numpy as np
from std_msgs.msg import Float64MultiArray, String, UInt8MultiArray

from robots_core.blocks.floating_base.rendezvous import CLOSE, Rendezvous
from robots_core.blocks.floating_base.rendezvous_messages import TYPES, RendezvousMessages
from robots_core.blocks.following.guide import Guide
from robots_core.ros.messages import BUILD, message_class
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription


class RendezvousTopics:
    """Takes the gripper's output and the guide; publishes inputs, measured poses, poses and momentum."""

    def __init__(self, node: RobotNode, rendezvous: Rendezvous) -> None:
        self._node, self._rendezvous = node, rendezvous
        self._guides = PolledSubscription(node, String, 'guide')
        self._outputs = PolledSubscription(node, UInt8MultiArray, 'digital_outputs')
        self._digital = make_publisher(node, UInt8MultiArray, 'digital_inputs')
        self._analog = make_publisher(node, Float64MultiArray, 'analog_inputs')
        self._messages = RendezvousMessages(rendezvous, BUILD, node.robot_name)
        self._publishers = {
            topic: make_publisher(node, message_class(kind), topic) for topic, kind in TYPES.items()
        }
        self._set: tuple[Any, Any] = (None, None)
        self._publish_inputs()

    def before_step(self) -> None:
        """Take what has come, before the drives move."""
        guide = self._guides.take()
        if guide is not None:
            self._rendezvous.guided = guide.data == Guide.SENSOR
        outputs = self._outputs.take()
        if outputs is not None:
            self._rendezvous.close(closing=len(outputs.data) >= CLOSE and bool(outputs.data[CLOSE - 1]))

    def after_step(self) -> None:
        """Publish, after the drives have moved."""
        bodies, stamp = self._rendezvous, self._node.get_clock().now().to_msg()
        for topic, message in self._messages.after_step(stamp, bodies.reference):
            self._publishers[topic].publish(message)
            if topic == 'grasp_status' and bodies.refused:
                self._node.journal.warning(bodies.report)
            elif topic == 'grasp_status' and bodies.report:
                self._node.journal.info(bodies.report)
        self._publish_inputs()

    def _publish_inputs(self) -> None:
        digital, analog = self._rendezvous.digital_inputs, self._rendezvous.measured
        if digital != self._set[0]:
            self._digital.publish(BUILD.image('digital_inputs', np.array(digital), labelled=False))
        if analog != self._set[1]:
            self._analog.publish(BUILD.image('analog_inputs', np.array(analog), labelled=False))
        self._set = digital, analog
