"""Which nodes publish, subscribe and serve: by the ROS graph, in lock-step by the run's participants.

The middleware finds nodes, and misses those that are gone, in its own time. In lock-step only participants
count: all were found before the run began, and none may leave it.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from robots_core.ros.lockstep.protocol import Kind
from robots_core.ros.timed_node import TimedNode

UNKNOWN_NODE: Final = '_NODE_NAME_UNKNOWN_'
UNKNOWN: Final = 'an unknown node'
PATIENCE: Final = 0.1  # s: a message may come before the name of its publisher's node
CHECK_PERIOD: Final = 0.005  # s


def publishers_of(node: TimedNode, topic: str) -> Mapping[bytes, str]:
    """The publishers of a topic: full name of the node by the publisher's identity."""
    if node.participant is not None:
        return _endpoints(node, topic, 'publisher')
    return _names(node.get_publishers_info_by_topic(topic))


def subscribers_of(node: TimedNode, topic: str) -> set[str]:
    """Full names of the nodes that are subscribed to a topic."""
    if node.participant is not None:
        return {*_endpoints(node, topic, 'subscription').values()}
    return {*_names(node.get_subscriptions_info_by_topic(topic)).values()}


def is_served(node: TimedNode, client: Any) -> bool:
    """A node serves what the client would call."""
    if node.participant is not None:
        return bool(_endpoints(node, client.service_name, 'service'))
    return bool(client.service_is_ready())


def _endpoints(node: TimedNode, name: str, kind: Kind) -> dict[bytes, str]:
    assert node.participant is not None
    full_name = node.resolve_topic_name(name)
    return {
        f'{participant}:{number}'.encode(): participant
        for participant, endpoints in node.participant.members.items()
        for number, endpoint in enumerate(endpoints)
        if endpoint.kind == kind and endpoint.name == full_name
    }


def _names(found: Any) -> dict[bytes, str]:
    return {
        bytes(one.endpoint_gid): f'{one.node_namespace.rstrip("/")}/{one.node_name}'
        for one in found
        if one.node_name != UNKNOWN_NODE
    }


@dataclass(frozen=True)
class Sender:
    """Where a message comes from.

    Attributes:
        name: The node's full name; '' where the middleware does not identify publishers, and in lock-step.
        time: When it was sent, ns on the clock of the sender's system; 0 where that is not known.
    """

    name: str = ''
    time: int = 0


class PublisherNames:
    """Looks up by a publisher's identity which node it belongs to."""

    def __init__(self, publishers: Callable[[], Mapping[bytes, str]]) -> None:
        self._publishers = publishers
        self._names: dict[bytes, str] = {}

    def name(self, identity: bytes) -> str:
        """The node's full name; for the first message of a publisher this may take `PATIENCE`."""
        deadline = time.monotonic() + PATIENCE
        while identity not in self._names:
            self._names = dict(self._publishers())
            if identity in self._names:
                break
            if time.monotonic() >= deadline:
                return UNKNOWN
            time.sleep(CHECK_PERIOD)
        return self._names[identity]
