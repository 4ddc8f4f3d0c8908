"""UncountedEndpoints: publishers and subscriptions that the lock-step protocol itself needs."""

from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from robots_core.ros.lockstep.counted import NeverExecuted
from robots_core.ros.lockstep.profiles import NO_PUBLISHER_EVENTS, NO_SUBSCRIPTION_EVENTS


class UncountedEndpoints:
    """Creates endpoints whose messages are not counted.

    Args:
        node: The owner.
    """

    def __init__(self, node: Node) -> None:
        self._node = node

    def publisher(self, message_type: Any, topic: str, qos: QoSProfile) -> Any:
        """As `Node.create_publisher`."""
        return Node.create_publisher(
            self._node, message_type, topic, qos, event_callbacks=NO_PUBLISHER_EVENTS
        )

    def subscription(
        self, message_type: Any, topic: str, callback: Any, qos: QoSProfile, *, raw: bool = True
    ) -> Any:
        """As `Node.create_subscription`."""
        return Node.create_subscription(
            self._node,
            message_type,
            topic,
            callback,
            qos,
            raw=raw,
            event_callbacks=NO_SUBSCRIPTION_EVENTS,
        )

    def polled(self, message_type: Any, topic: str, qos: QoSProfile) -> Any:
        """A subscription that no executor empties."""
        return Node.create_subscription(
            self._node,
            message_type,
            topic,
            lambda _: None,
            qos,
            callback_group=NeverExecuted(),
            raw=True,
            event_callbacks=NO_SUBSCRIPTION_EVENTS,
        )
