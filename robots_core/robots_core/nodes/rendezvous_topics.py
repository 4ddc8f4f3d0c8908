"""RendezvousTopics: the bodies in orbit that drive_node moves, as topics."""

from collections.abc import Callable
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped, TwistStamped
from std_msgs.msg import Float64MultiArray, String, UInt8MultiArray

from robots_core.blocks.floating_base.rendezvous import CLOSE, WORLD_FRAME, Rendezvous
from robots_core.blocks.following.guide import Guide
from robots_core.ros.messages import (
    diagnostic_status,
    doubles,
    matrix_message,
    pose_stamped_message,
    twist_stamped_message,
)
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription


class RendezvousTopics:
    """Takes the gripper's output and the guide; publishes inputs, measured poses, poses and momentum.

    Args:
        node: The node of the drives.
        rendezvous: The bodies, stepped with the drives.
        on_report: Gets what became of a grasp, and whether it was refused.
    """

    def __init__(
        self, node: RobotNode, rendezvous: Rendezvous, on_report: Callable[[str, bool], None]
    ) -> None:
        self._node, self._rendezvous, self._on_report = node, rendezvous, on_report
        self._guides = PolledSubscription(node, String, 'guide')
        self._outputs = PolledSubscription(node, UInt8MultiArray, 'digital_outputs')
        self._digital = make_publisher(node, UInt8MultiArray, 'digital_inputs')
        self._analog = make_publisher(node, Float64MultiArray, 'analog_inputs')
        self._references = make_publisher(node, PoseStamped, 'reference_pose')
        self._twists = make_publisher(node, TwistStamped, 'reference_twist')
        self._base = make_publisher(node, PoseStamped, 'base_pose')
        self._target = make_publisher(node, PoseStamped, 'target_pose')
        self._momentum = make_publisher(node, Float64MultiArray, 'momentum')
        self._status = make_publisher(node, DiagnosticStatus, 'grasp_status')
        self._set: tuple[Any, Any] = (None, None)
        self._report: str | None = None
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
        if (reference := bodies.reference) is not None:
            self._references.publish(pose_stamped_message(stamp, reference[0]))
            self._twists.publish(twist_stamped_message(stamp, reference[1]))
        if bodies.report != self._report:
            self._report = bodies.report
            level = DiagnosticStatus.ERROR if bodies.refused else DiagnosticStatus.OK
            name = self._node.robot.name
            self._status.publish(diagnostic_status('grasp', bodies.report, level=level, hardware_id=name))
            self._on_report(bodies.report, bodies.refused)
        if bodies.shown:
            self._base.publish(pose_stamped_message(stamp, bodies.base.pose, WORLD_FRAME))
            self._target.publish(pose_stamped_message(stamp, bodies.target.pose, WORLD_FRAME))
            self._momentum.publish(matrix_message(bodies.momentum, 'part', 'momentum'))
        self._publish_inputs()

    def _publish_inputs(self) -> None:
        digital, analog = self._rendezvous.digital_inputs, self._rendezvous.measured
        if digital != self._set[0]:
            self._digital.publish(UInt8MultiArray(data=bytes(digital)))
        if analog != self._set[1]:
            self._analog.publish(Float64MultiArray(data=doubles(np.array(analog))))
        self._set = digital, analog
