"""Quality of service: one profile per kind of topic."""

from collections.abc import Callable
from typing import Any, Final

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy

# By default a profile keeps the last samples, reliably, and latches none.
STATE: Final = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Publishers of state: late subscribers get the newest value."""

STREAM: Final = QoSProfile(depth=1)
"""Subscribers to the newest sample alone, of which the last is never missed: fits publishers of state."""

SENSOR: Final = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Subscribers of a robot's sensors: fits every driver, those that send sensor data unacknowledged too."""

REFERENCE: Final = SENSOR
"""Subscribers of `joint_reference`: the next one comes before a lost one could be sent again.

So its publisher need not ask them again and again what they have received.
"""

COMMAND: Final = QoSProfile(depth=100)
"""Commands and results: all of them, also of a program that blends many motions, and none from before."""


def subscribe_state(node: Node, message_type: Any, topic: str, callback: Callable[[Any], None]) -> None:
    """Subscribe to a state topic, latched or not.

    A latched value only reaches a transient-local subscriber, and such a subscriber does not match a
    publisher that latches nothing (most PLC bridges). So there are two; the callback may see a message
    twice and must not mind.
    """
    node.create_subscription(message_type, topic, callback, STREAM)
    subscribe_quietly(node, message_type, topic, callback, STATE)


def subscribe_quietly(
    node: Node, message_type: Any, topic: str, callback: Callable[[Any], None], qos: QoSProfile
) -> None:
    """Subscribe beside another subscription that hears the publishers which this one does not match.

    It does not warn that nothing will be received from them.
    """
    quiet = SubscriptionEventCallbacks(use_default_callbacks=False)
    node.create_subscription(message_type, topic, callback, qos, event_callbacks=quiet)


def subscribe_any(
    node: Node, message_type: Any, topic: str, callback: Callable[[Any], None], qos: QoSProfile
) -> None:
    """Subscribe reliably and, once somebody publishes the topic without acknowledgement, in that way too.

    A reliable subscriber does not match such publishers. From then on the callback may see messages twice.
    """
    unacknowledged = QoSProfile(depth=qos.depth, reliability=ReliabilityPolicy.BEST_EFFORT)
    found = False

    def on_incompatible(event: Any) -> None:
        nonlocal found
        if event.last_policy_kind == QoSPolicyKind.RELIABILITY and not found:
            found = True
            subscribe_quietly(node, message_type, topic, callback, unacknowledged)

    events = SubscriptionEventCallbacks(incompatible_qos=on_incompatible, use_default_callbacks=False)
    node.create_subscription(message_type, topic, callback, qos, event_callbacks=events)
