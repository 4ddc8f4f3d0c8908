"""A subscription that a real-time loop empties itself, without the executor."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Generic, TypeVar

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import QoSProfile

Message = TypeVar('Message')


class _Polled(CallbackGroup):
    """Entities that no executor may take."""

    def can_execute(self, entity: Any) -> bool:
        del entity
        return False

    def beginning_execution(self, entity: Any) -> bool:
        del entity
        return False

    def ending_execution(self, entity: Any) -> None:
        del entity


class PolledSubscription(Generic[Message]):
    """Newest message of a topic, taken when asked for.

    Waking the executor costs several times what taking a message does; a loop that looks once per period
    anyway needs no waking.

    Args:
        node: Where the subscription belongs.
        message_type: The topic's type.
        topic: The topic's name.
        qos: Depth 1 for the newest message only.
        raw: Take messages as bytes, not deserialized.
    """

    def __init__(
        self, node: Node, message_type: type[Message], topic: str, qos: QoSProfile, *, raw: bool = False
    ) -> None:
        self._subscription = node.create_subscription(
            message_type, topic, _never_called, qos, callback_group=_Polled(), raw=raw
        )

    def take(self) -> Message | None:
        """The newest message since the last call, or None."""
        newest: Message | None = None
        for message, _ in self.take_all():
            newest = message
        return newest

    def take_all(self) -> Iterator[tuple[Message, dict[str, int]]]:
        """All messages since the last call, oldest first, each with its info (`source_timestamp`, ns)."""
        subscription = self._subscription
        while True:
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None:
                return
            yield taken

    @property
    def publishers(self) -> int:
        """Number of publishers that this subscription hears."""
        return int(self._subscription.get_publisher_count())


def _never_called(message: object) -> None:
    del message
