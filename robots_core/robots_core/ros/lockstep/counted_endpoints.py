"""Publishers, subscriptions, services and clients whose messages are counted."""

import inspect
import threading
from collections.abc import Callable
from typing import Any, Protocol

from rclpy.callback_groups import CallbackGroup
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

DEPTH = 1000
POLLED_DEPTH = 100


class Counter(Protocol):
    """What the endpoints of a participant need of it."""

    def sent(self, index: int) -> None:
        """A message was sent."""

    def received(self, index: int) -> None:
        """A message was handled."""

    def enter(self) -> None:
        """A callback begins: bring the time up to date, and hold reports back until it ends."""

    def leave(self) -> None:
        """The callback has ended: report."""


class CountedPublisher(Publisher):
    """A publisher that counts; before `release` it holds messages back, so that all of them are received."""

    held: list[Any] | None
    """Messages that are held back."""
    _counter: Counter
    _index: int
    _lock: threading.Lock

    def count(self, counter: Counter, index: int) -> None:
        """Count as endpoint `index` from now on."""
        self._counter, self._index = counter, index
        self.held, self._lock = [], threading.Lock()

    def publish(self, msg: Any) -> None:
        """Send a message, serialized or not."""
        if self.held is not None:
            with self._lock:
                if self.held is not None:
                    self.held.append(msg)
                    return
        # Before it is sent: it must not be received by more than have been counted.
        self._counter.sent(self._index)
        super().publish(msg)

    def release(self) -> None:
        """Send what was held back; from now on messages are sent at once."""
        with self._lock:
            held, self.held = self.held or [], None
            for message in held:
                self._counter.sent(self._index)
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


def counted_callback(callback: Callable[..., Any], counter: Counter, index: int) -> Callable[..., None]:
    """The callback of a subscription, counted when it has returned."""

    def handle(*message: Any) -> None:
        counter.enter()
        try:
            callback(*message)
        finally:
            counter.received(index)
            counter.leave()

    try:
        inspect.signature(callback).bind(object())
    except TypeError:
        return lambda message, info: handle(message, info)  # noqa: PLW0108  # rclpy counts the arguments
    return lambda message: handle(message)  # noqa: PLW0108


def count_service(service: Any, counter: Counter, index: int) -> None:
    """Count the requests that a service has answered."""
    callback, send_response = service.callback, service.send_response

    def serve(request: Any, response: Any) -> Any:
        counter.enter()
        return callback(request, response)

    def send(response: Any, header: Any) -> None:
        try:
            send_response(response, header)
        finally:
            counter.received(index)
            counter.leave()

    service.callback, service.send_response = serve, send


def count_client(
    client: Any, counter: Counter, index: int, after_callbacks: Callable[[Callable[[], None]], None]
) -> None:
    """Count the requests of a client as endpoint `index`, its replies as the next.

    Args:
        client: The client.
        counter: Counts them.
        index: Of the requests.
        after_callbacks: Calls a function in the executor's thread, after those that already wait there: the
            callbacks of a reply are among them.
    """
    call_async = client.call_async

    def handled() -> None:
        counter.received(index + 1)
        counter.leave()

    def replied(_: Any) -> None:
        counter.enter()
        after_callbacks(handled)

    def call(request: Any) -> Any:
        counter.sent(index)
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
