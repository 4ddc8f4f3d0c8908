"""BagPlayer: publishes a bag onto real topics, with its timing."""

from __future__ import annotations

import threading
import time
from typing import Any, Final

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from robots_controller.recording.bag_replay import ReplayPlan
from robots_core.ros.message_class import message_class

POLL: Final = 0.01  # s between looks for subscribers
DEPTH: Final = 1000  # messages that a slow subscriber may lag behind
LAST_ACKNOWLEDGEMENT: Final = Duration(seconds=2.0)


class BagPlayer(Node):
    """Publishes what a plan says; latched topics stay latched, all are reliable.

    Args:
        plan: What to publish when.
        options: Passed on to `rclpy.node.Node`.

    Raises:
        RobotsError: a message type that is not installed.
    """

    def __init__(self, plan: ReplayPlan, **options: Any) -> None:
        super().__init__('bag_player', **options)
        self._plan = plan
        self._player_publishers: dict[str, Any] = {}
        for name, topic in plan.topics.items():
            durability = DurabilityPolicy.TRANSIENT_LOCAL if topic.latched else DurabilityPolicy.VOLATILE
            # One latched message is the state; more of them would be played again to who comes late.
            qos = QoSProfile(depth=1 if topic.latched else DEPTH, durability=durability)
            self._player_publishers[name] = self.create_publisher(message_class(topic.type), name, qos)
        for name, data in plan.state:
            self._player_publishers[name].publish(data)

    def unheard(self) -> list[str]:
        """Topics that nobody is subscribed to."""
        return [name for name, one in self._player_publishers.items() if one.get_subscription_count() == 0]

    def wait_for_subscribers(self, timeout: float, stop: threading.Event) -> list[str]:
        """Wait until every topic has a subscriber; returns those that have none after `timeout` s."""
        deadline = time.monotonic() + timeout
        while (unheard := self.unheard()) and time.monotonic() < deadline and not stop.is_set():
            stop.wait(POLL)
        return unheard

    def play(self, stop: threading.Event) -> int:
        """Publish everything on time; returns how many messages were published before `stop` was set."""
        start = time.monotonic()
        count = 0
        for due, name, data in self._plan.timeline:
            if stop.wait(max(0.0, start + due - time.monotonic())):
                return count
            self._player_publishers[name].publish(data)
            count += 1
        for publisher in self._player_publishers.values():
            publisher.wait_for_all_acked(LAST_ACKNOWLEDGEMENT)
        return count
