"""NamesakeWatch: of two nodes with one name, the later one ends."""

from functools import partial
from typing import Final

from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import UInt64

from robots_core.errors import NotNowError
from robots_core.ros.lockstep.counted_endpoints import NeverExecuted
from robots_core.ros.peers.heartbeat import HEARTBEAT, Heartbeat
from robots_core.ros.peers.identified_messages import IdentifiedMessages, publishers_are_identified
from robots_core.ros.peers.presence import publishers_of
from robots_core.ros.timed_node import TimedNode

PERIOD: Final = 0.2  # s
BEATS: Final = QoSProfile(depth=50, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Those of both nodes in a period, and of some before."""


class NamesakeWatch:
    """Listens to the heartbeats of a node's own name; their numbers are the times when they began.

    A dead node sends none, so one that is started after it stays. Only publishers of a node with the same
    full name count, and only where the middleware identifies publishers.

    Args:
        node: The node.
        heartbeat: Its own.
    """

    def __init__(self, node: TimedNode, heartbeat: Heartbeat) -> None:
        self._node, self._began = node, heartbeat.began
        if not publishers_are_identified():
            return
        topic = f'{node.get_name()}/{HEARTBEAT}'
        subscription = node.create_subscription(
            UInt64, topic, lambda _: None, BEATS, callback_group=NeverExecuted()
        )
        self._beats = IdentifiedMessages(subscription)
        self._publishers = partial(publishers_of, node, topic)
        node.create_timer(PERIOD, self._check)

    def _check(self) -> None:
        earlier: set[bytes] = set()
        while (taken := self._beats.take()) is not None:
            beat, publisher = taken
            if beat.data < self._began:
                earlier.add(publisher)
        if not earlier:
            return
        name, publishers = self._node.get_fully_qualified_name(), self._publishers()
        if any(publishers.get(publisher) == name for publisher in earlier):
            raise NotNowError(
                f'{name} runs already; a second one would command the same robot. End the first one, or give '
                'this one another namespace'
            )
