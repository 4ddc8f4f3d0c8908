"""Which nodes publish, subscribe and serve: by the ROS graph, in lock-step by the run's participants.

The middleware finds nodes, and misses those that are gone, in its own time. In lock-step only participants
count: all were found before the run began, and none may leave it.
"""

from collections.abc import Mapping
from typing import Any

from robots_core.ros.lockstep.protocol import Kind
from robots_core.ros.timed_node import TimedNode

UNKNOWN_NODE = '_NODE_NAME_UNKNOWN_'


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
