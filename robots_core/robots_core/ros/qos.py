"""Endpoints of topics with the quality of service of `topic_qos.TOPIC_QOS`."""

from collections.abc import Callable
from typing import Any, Final

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy

from robots_core.cell_interface import topic_qos as table
from robots_core.cell_interface.topic_qos import Profile, topic_qos

EVERY_MESSAGE_DEPTH: Final = 100


def rclpy_profile(profile: Profile) -> QoSProfile:
    """A profile as rclpy has it."""
    return QoSProfile(
        depth=profile.depth,
        reliability=ReliabilityPolicy.RELIABLE if profile.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if profile.latched else DurabilityPolicy.VOLATILE,
    )


_RCLPY: Final = {profile: rclpy_profile(profile) for profile in table.PROFILES}

# For topics of others, which the table does not have.
STATE: Final = _RCLPY[table.STATE]
STREAM: Final = _RCLPY[table.STREAM]
SENSOR: Final = _RCLPY[table.SENSOR]
COMMAND: Final = _RCLPY[table.COMMAND]


def polled_qos(topic: str) -> QoSProfile:
    """Of a subscription that a loop empties itself."""
    return _RCLPY[topic_qos(topic).polled]


def every_message(topic: str) -> QoSProfile:
    """Of a subscription that shows all that happens, also what is latched from before."""
    latched = topic_qos(topic).published.latched
    return rclpy_profile(Profile('', '', depth=EVERY_MESSAGE_DEPTH, latched=latched))


def make_publisher(node: Node, message_type: Any, topic: str) -> Any:
    """A publisher of a topic of the suite."""
    return node.create_publisher(message_type, topic, _RCLPY[topic_qos(topic).published])


def subscribe(
    node: Node, message_type: Any, topic: str, callback: Callable[[Any], None], **options: Any
) -> Any:
    """Subscribe to a topic of the suite; where anyone may publish it the callback may get messages twice.

    Args:
        node: Whose subscription.
        message_type: The topic's type.
        topic: Its name, perhaps in another namespace.
        callback: Gets the messages.
        options: Of `Node.create_subscription`, for topics with one subscription.

    Returns:
        The first subscription.
    """
    qos = topic_qos(topic)
    first, *others = (_RCLPY[profile] for profile in qos.subscribed)
    if qos.unacknowledged:
        subscription = subscribe_any(node, message_type, topic, callback, first)
    else:
        subscription = node.create_subscription(message_type, topic, callback, first, **options)
    for other in others:
        _subscribe_quietly(node, message_type, topic, callback, other)
    return subscription


def subscribe_any_state(node: Node, message_type: Any, topic: str, callback: Callable[[Any], None]) -> None:
    """Subscribe to a state of others, latched or not; the callback may get messages twice."""
    node.create_subscription(message_type, topic, callback, STREAM)
    _subscribe_quietly(node, message_type, topic, callback, STATE)


def _subscribe_quietly(
    node: Node, message_type: Any, topic: str, callback: Callable[[Any], None], qos: QoSProfile
) -> None:
    """Subscribe beside another subscription that matches the publishers which this one does not.

    It does not warn that nothing will be received from them.
    """
    quiet = SubscriptionEventCallbacks(use_default_callbacks=False)
    node.create_subscription(message_type, topic, callback, qos, event_callbacks=quiet)


def subscribe_any(
    node: Node, message_type: Any, topic: str, callback: Callable[[Any], None], qos: QoSProfile
) -> Any:
    """Subscribe reliably and, once somebody publishes the topic without acknowledgement, in that way too.

    A reliable subscriber does not match such publishers. From then on the callback may see messages twice.
    """
    unacknowledged = QoSProfile(depth=qos.depth, reliability=ReliabilityPolicy.BEST_EFFORT)
    found = False

    def on_incompatible(event: Any) -> None:
        nonlocal found
        if event.last_policy_kind == QoSPolicyKind.RELIABILITY and not found:
            found = True
            _subscribe_quietly(node, message_type, topic, callback, unacknowledged)

    events = SubscriptionEventCallbacks(incompatible_qos=on_incompatible, use_default_callbacks=False)
    return node.create_subscription(message_type, topic, callback, qos, event_callbacks=events)
