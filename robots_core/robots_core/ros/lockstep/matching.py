"""Whether the endpoints of a roster have found each other."""

from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from robots_core.ros.lockstep.protocol import Endpoint, Roster


def unmatched(node: Node, endpoint: Endpoint, entity: Any, roster: Roster) -> str:
    """What an endpoint of a node still has to find in the network; '' for nothing."""
    if endpoint.kind == 'publisher':
        return _unmatched_publisher(node, endpoint, entity, roster)
    if endpoint.kind in {'subscription', 'polled'}:
        return _unmatched_subscription(node, endpoint, entity, roster)
    served = any(Endpoint('service', endpoint.name) in one for one in roster.participants.values())
    if endpoint.kind == 'requests' and served and not entity.service_is_ready():
        return f'the service {endpoint.name} was not found'
    return ''


def _unmatched_publisher(node: Node, endpoint: Endpoint, publisher: Any, roster: Roster) -> str:
    """Why a publisher does not reach every subscription of the roster yet; '' if it does.

    Subscriptions of nodes that do not take part have to be matched too: a count does not show which are.
    """
    topic, latched = endpoint.name, endpoint.latched
    wanted = [
        participant
        for participant, endpoints in roster.participants.items()
        for one in endpoints
        if one.name == topic
        and one.kind in {'subscription', 'polled', 'recorded'}
        and (latched or not one.latched)
    ]
    found = [
        info
        for info in node.get_subscriptions_info_by_topic(topic)
        if latched or info.qos_profile.durability is not DurabilityPolicy.TRANSIENT_LOCAL
    ]
    return _problem(topic, 'subscription', wanted, found, publisher.get_subscription_count())


def _unmatched_subscription(node: Node, endpoint: Endpoint, subscription: Any, roster: Roster) -> str:
    """Why a subscription does not match every publisher of the roster yet; '' if it does."""
    topic, latched = endpoint.name, endpoint.latched
    wanted = [
        participant
        for participant, endpoints in roster.participants.items()
        for one in endpoints
        if one.name == topic and one.kind == 'publisher' and (one.latched or not latched)
    ]
    found = [
        info
        for info in node.get_publishers_info_by_topic(topic)
        if info.qos_profile.reliability is ReliabilityPolicy.RELIABLE
        if not latched or info.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
    ]
    return _problem(topic, 'publisher', wanted, found, subscription.get_publisher_count())


def _problem(
    topic: str, what: str, wanted: Sequence[str], found: Sequence[TopicEndpointInfo], matched: int
) -> str:
    names = [f'{info.node_namespace.rstrip("/")}/{info.node_name}' for info in found]
    missing = [name for name in dict.fromkeys(wanted) if names.count(name) < wanted.count(name)]
    if missing:
        return f'the {what} of {missing[0]} on {topic} was not found'
    if matched < len(found):
        return f'{matched} of {len(found)} {what}s on {topic} are matched'
    return ''
