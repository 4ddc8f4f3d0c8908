"""Publishers, subscriptions, services and clients whose messages a participant counts."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

if TYPE_CHECKING:
    from robots_core.ros.lockstep.participant import Participant

DEPTH = 1000
POLLED_DEPTH = 100
ALL: Final = QoSProfile(depth=DEPTH)
# Every kind of event is one more thing to wait for; by default each endpoint warns of incompatible qualities.
NO_PUBLISHER_EVENTS: Final = PublisherEventCallbacks(use_default_callbacks=False)
NO_SUBSCRIPTION_EVENTS: Final = SubscriptionEventCallbacks(use_default_callbacks=False)


class CountedPublisher(Publisher):
    """A publisher that counts; before `release` it holds messages back, so that all of them are received."""

    held: list[Any] | None
    """Messages that are held back."""
    _participant: Participant
    _index: int
    _lock: threading.Lock

    def count(self, participant: Participant, index: int) -> None:
        """Count as endpoint `index` from now on."""
        self._participant, self._index = participant, index
        self.held, self._lock = [], threading.Lock()

    def publish(self, msg: Any) -> None:
        """Send a message, serialized or not."""
        if self.held is not None:
            with self._lock:
                if self.held is not None:
                    self.held.append(msg)
                    return
        # Before it is sent: it must not be received by more than have been counted.
        self._participant.sent(self._index)
        super().publish(msg)

    def release(self) -> None:
        """Send what was held back; from now on messages are sent at once."""
        with self._lock:
            held, self.held = self.held or [], None
            for message in held:
                self._participant.sent(self._index)
                super().publish(message)


def reliable(qos: QoSProfile | int, depth: int) -> QoSProfile:
    """The profile with which nothing is lost; durability and liveliness stay."""
    profile = QoSProfile(depth=qos) if isinstance(qos, int) else qos
    return QoSProfile(
        depth=max(depth, profile.depth),
        reliability=ReliabilityPolicy.RELIABLE,
        durability=profile.durability,
        liveliness=profile.liveliness,
        liveliness_lease_duration=profile.liveliness_lease_duration,
    )


def is_latched(qos: QoSProfile) -> bool:
    """The profile is transient-local."""
    return bool(qos.durability is DurabilityPolicy.TRANSIENT_LOCAL)


def counted_callback(
    callback: Callable[..., Any], participant: Participant, index: int
) -> Callable[..., None]:
    """The callback of a subscription, counted when it has returned."""

    def handle(*message: Any) -> None:
        participant.enter()
        try:
            callback(*message)
        finally:
            participant.received(index)
            participant.leave()

    try:
        inspect.signature(callback).bind(object())
    except TypeError:
        return lambda message, info: handle(message, info)  # noqa: PLW0108  # rclpy counts the arguments
    return lambda message: handle(message)  # noqa: PLW0108


def count_service(service: Any, participant: Participant, index: int) -> None:
    """Count the requests that a service has answered."""
    callback, send_response = service.callback, service.send_response

    def serve(request: Any, response: Any) -> Any:
        participant.enter()
        return callback(request, response)

    def send(response: Any, header: Any) -> None:
        try:
            send_response(response, header)
        finally:
            participant.received(index)
            participant.leave()

    service.callback, service.send_response = serve, send


def count_client(client: Any, participant: Participant, index: int) -> None:
    """Count the requests of a client as endpoint `index`, its replies as the next."""
    call_async = client.call_async

    def handled() -> None:
        participant.received(index + 1)
        participant.leave()

    def replied(_: Any) -> None:
        participant.enter()
        participant.after_callbacks(handled)

    def call(request: Any) -> Any:
        participant.sent(index)
        future = call_async(request)
        future.add_done_callback(replied)
        return future

    client.call_async = call


class NeverExecuted(CallbackGroup):
    """Entities that no executor may take: their owner takes the messages."""

    def can_execute(self, entity: Any) -> bool:
        """Never."""
        del entity
        return False
