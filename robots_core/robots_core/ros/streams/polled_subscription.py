"""Subscriptions that a real-time loop empties itself, without the executor."""

import math
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import QoSProfile

from robots_core.ros.lockstep.counted_endpoints import NeverExecuted
from robots_core.ros.lockstep.participant import PATIENCE, Participant
from robots_core.ros.peers.identified_messages import IdentifiedMessages
from robots_core.ros.qos import polled_qos


class PolledSubscription:
    """Newest message of a topic, taken when asked for.

    Waking the executor costs several times what taking a message does; a loop that looks once per period
    anyway needs no waking. In lock-step, what was sent in earlier phases is waited for when the loop polls:
    the messages taken do not depend on the machine. One thread at a time takes messages.

    Args:
        node: Where the subscription belongs.
        message_type: The topic's type.
        topic: The topic's name.
        qos: Depth 1 for the newest message only; by default that of the suite's topic.
        raw: Take messages as bytes, not deserialized.
    """

    def __init__(
        self,
        node: Node,
        message_type: Any,
        topic: str,
        qos: QoSProfile | None = None,
        *,
        raw: bool = False,
    ) -> None:
        qos = polled_qos(topic) if qos is None else qos
        self._subscription = node.create_subscription(
            message_type, topic, lambda _: None, qos, callback_group=NeverExecuted(), raw=raw
        )
        participant: Participant | None = getattr(node, 'participant', None)
        self._participant = None if participant is None or participant.started else participant
        self._topic: str = self._subscription.topic_name
        self._now: Callable[[], float] = getattr(node, 'now', time.monotonic)
        self._watch = node.writer_watch(topic) if hasattr(node, 'writer_watch') else None
        if self._watch is not None:
            self._identified = IdentifiedMessages(self._subscription)
            self._waiting: tuple[Any, bytes] | None = None
        self._newest = 0  # sequence number of the message
        self.received = 0
        """When the message of a stream that was taken last arrived, ns on the clock of this system."""

    @property
    def handle(self) -> Any:
        """The subscription, as wait sets of rclpy take it."""
        return self._subscription.handle

    def take(self) -> Any:
        """The newest message since the last call, or None."""
        newest = None
        for message, _ in self.take_all():
            newest = message
        return newest

    def take_all(self) -> Iterator[tuple[Any, dict[str, int]]]:
        """All messages since the last call, oldest first, each with its info (`source_timestamp`, ns).

        There is no info where a topic has its writers (see `RobotNode.writer_watch`).
        """
        subscription, deadline = self._subscription, math.inf
        if self._watch is not None:
            waiting, self._waiting = self._waiting, None
            while (identified := waiting or self._identified.take()) is not None:
                waiting, (message, identity) = None, identified
                if self._watch.accepts(identity, self._now()):
                    self.received = self._identified.received
                    yield message, {}
                elif self._watch.waits(identity):
                    self._waiting = identified
            return
        while True:
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is not None:
                self._newest = taken[1]['publication_sequence_number']
                self.received = taken[1]['received_timestamp']
                deadline = math.inf
                yield taken
            elif self._participant is None or not self._participant.is_behind(self._topic, self._newest):
                return
            else:
                deadline = min(deadline, time.monotonic() + PATIENCE)
                self._participant.wait_for_message(self._topic, deadline)

    @property
    def publishers(self) -> int:
        """Number of matched publishers."""
        return int(self._subscription.get_publisher_count())


class Arrivals:
    """Waits until a message has come for any of several subscriptions."""

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
            wait_set.wait(max(0, int(1e9 * timeout)))  # below 0 it would wait without end
            return bool(wait_set.get_ready_entities('subscription'))
