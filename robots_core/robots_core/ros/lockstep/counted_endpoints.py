"""Publishers, subscriptions, services and clients whose messages a participant counts, and the counts."""

from __future__ import annotations

import inspect
import threading
from collections import Counter
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from rclpy.callback_groups import CallbackGroup
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from robots_core.ros.lockstep.protocol import Endpoint, Kind, Roster
from robots_core.ros.lockstep.traffic import CLOSED

if TYPE_CHECKING:
    from robots_core.ros.lockstep.participant import Participant

DEPTH = 1000
POLLED_DEPTH = 100
ALL: Final = QoSProfile(depth=DEPTH)
# Every kind of event is one more thing to wait for; by default each endpoint warns of incompatible qualities.
NO_PUBLISHER_EVENTS: Final = PublisherEventCallbacks(use_default_callbacks=False)
NO_SUBSCRIPTION_EVENTS: Final = SubscriptionEventCallbacks(use_default_callbacks=False)
# The kinds that an endpoint of a topic has to find.
OPPOSITE: Final[Mapping[Kind, tuple[Kind, ...]]] = {
    'publisher': ('subscription', 'polled', 'recorded'),
    'subscription': ('publisher',),
    'polled': ('publisher',),
}


class Counts:
    """The endpoints of a participant, with a count that grows each; from any thread."""

    def __init__(self) -> None:
        self.endpoints: list[Endpoint] = []
        """In the order of their numbers."""
        self.entities: list[Any] = []
        """Publishers, subscriptions, services and clients, one for each endpoint."""
        self._counts: list[int] = []
        self._reported: list[int] = []
        self._lock = threading.Lock()

    def add(self, endpoint: Endpoint, entity: Any) -> int:
        """Count an endpoint too; returns its number."""
        with self._lock:
            self.endpoints.append(endpoint)
            self.entities.append(entity)
            self._counts.append(0)
            return len(self._counts) - 1

    def sent(self, index: int) -> None:
        """A message is being sent."""
        with self._lock:
            self._counts[index] += 1

    def received(self, index: int) -> None:
        """A message was handled, of a subscription that is still there."""
        with self._lock:
            if self._counts[index] != CLOSED:
                self._counts[index] += 1

    def close(self, entity: Any) -> None:
        """A subscription ends: nothing waits for what it has not received."""
        for index, one in enumerate(self.entities):
            if one is entity and self.endpoints[index].kind == 'subscription':
                self._counts[index] = CLOSED

    def changes(self) -> list[int]:
        """Endpoints whose counts have changed since the last call, each followed by its count."""
        with self._lock:
            found: list[int] = []
            if self._counts != self._reported:
                for index, count in enumerate(self._counts):
                    if index >= len(self._reported) or count != self._reported[index]:
                        found += (index, count)
                self._reported = list(self._counts)
            return found

    def forget(self) -> None:
        """Have all counts among the next changes."""
        self._reported = []


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


def is_matched(node: Node, endpoint: Endpoint, entity: Any, roster: Roster) -> bool:
    """An endpoint of a node has found all that it has to find in the network."""
    if endpoint.kind in OPPOSITE:
        return _is_matched_on_topic(node, endpoint, entity, roster)
    served = any(Endpoint('service', endpoint.name) in one for one in roster.participants.values())
    return bool(endpoint.kind != 'requests' or not served or entity.service_is_ready())


def _is_matched_on_topic(node: Node, endpoint: Endpoint, entity: Any, roster: Roster) -> bool:
    """An endpoint of a topic matches each of the other kind in the roster.

    Those of nodes that do not take part have to be matched too: a count does not show which are.
    """
    publishes = endpoint.kind == 'publisher'

    def fits(latched: bool) -> bool:  # noqa: FBT001
        """A latched subscription does not match a publisher that is not latched."""
        return latched <= endpoint.latched if publishes else endpoint.latched <= latched

    wanted = Counter(
        participant
        for participant, endpoints in roster.participants.items()
        for one in endpoints
        if one.name == endpoint.name and one.kind in OPPOSITE[endpoint.kind] and fits(one.latched)
    )
    infos = node.get_subscriptions_info_by_topic if publishes else node.get_publishers_info_by_topic
    found = Counter(
        f'{info.node_namespace.rstrip("/")}/{info.node_name}'
        for info in infos(endpoint.name)
        if publishes or info.qos_profile.reliability is ReliabilityPolicy.RELIABLE
        if fits(info.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL)
    )
    matched = entity.get_subscription_count() if publishes else entity.get_publisher_count()
    return bool(wanted <= found and matched >= found.total())
