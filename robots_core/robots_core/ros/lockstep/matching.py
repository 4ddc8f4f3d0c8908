"""Whether the endpoints of a roster have found each other."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from robots_core.ros.lockstep.protocol import Endpoint, Kind, Roster

# The kinds that an endpoint of a topic has to find.
OPPOSITE: Final[Mapping[Kind, tuple[Kind, ...]]] = {
    'publisher': ('subscription', 'polled', 'recorded'),
    'subscription': ('publisher',),
    'polled': ('publisher',),
}


def unmatched(node: Node, endpoint: Endpoint, entity: Any, roster: Roster) -> str:
    """What an endpoint of a node still has to find in the network; '' for nothing."""
    if endpoint.kind in OPPOSITE:
        return _unmatched_on_topic(node, endpoint, entity, roster)
    served = any(Endpoint('service', endpoint.name) in one for one in roster.participants.values())
    if endpoint.kind == 'requests' and served and not entity.service_is_ready():
        return f'the service {endpoint.name} was not found'
    return ''


def _unmatched_on_topic(node: Node, endpoint: Endpoint, entity: Any, roster: Roster) -> str:
    """Why an endpoint of a topic does not match each of the other kind in the roster yet; '' if it does.

    Those of nodes that do not take part have to be matched too: a count does not show which are.
    """
    topic, publishes = endpoint.name, endpoint.kind == 'publisher'

    def fits(latched: bool) -> bool:  # noqa: FBT001
        """A latched subscription does not match a publisher that is not latched."""
        return latched <= endpoint.latched if publishes else endpoint.latched <= latched

    wanted = [
        participant
        for participant, endpoints in roster.participants.items()
        for one in endpoints
        if one.name == topic and one.kind in OPPOSITE[endpoint.kind] and fits(one.latched)
    ]
    infos = node.get_subscriptions_info_by_topic if publishes else node.get_publishers_info_by_topic
    found = [
        info
        for info in infos(topic)
        if publishes or info.qos_profile.reliability is ReliabilityPolicy.RELIABLE
        if fits(info.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL)
    ]
    matched = entity.get_subscription_count() if publishes else entity.get_publisher_count()
    return _problem(topic, 'subscription' if publishes else 'publisher', wanted, found, matched)


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
