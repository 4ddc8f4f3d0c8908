"""Arrivals: waits for messages of polled subscriptions, in the thread that polls them."""

from collections.abc import Iterable
from contextlib import ExitStack
from typing import Final

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from robots_core.ros.streams.polled_subscription import PolledSubscription

NANOSECONDS: Final = 1e9  # per second


class Arrivals:
    """Waits until a message has come for any of several subscriptions.

    Args:
        node: Of the subscriptions.
        subscriptions: At least one.
    """

    def __init__(self, node: Node, subscriptions: Iterable[PolledSubscription]) -> None:
        self._handles = [one.handle for one in subscriptions]
        self._wait_set = rclpy_implementation.WaitSet(len(self._handles), 0, 0, 0, 0, 0, node.context.handle)

    def wait(self, timeout: float) -> bool:
        """Wait, at most for `timeout`, s; whether a message has come."""
        wait_set = self._wait_set
        with ExitStack() as held:
            wait_set.clear_entities()
            for handle in self._handles:
                held.enter_context(handle)
                wait_set.add_subscription(handle)
            wait_set.wait(max(0, int(NANOSECONDS * timeout)))  # below 0 it would wait without end
            return bool(wait_set.get_ready_entities('subscription'))
