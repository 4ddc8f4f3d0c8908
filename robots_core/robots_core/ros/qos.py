"""Quality of service: one profile per kind of topic."""

from collections.abc import Callable
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

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
    for qos in (STREAM, STATE):
        node.create_subscription(message_type, topic, callback, qos)
