"""Whether the endpoints of a roster have found each other."""

from collections import Counter
from collections.abc import Mapping
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

from robots_core.ros.lockstep.protocol import Endpoint, Kind, Roster

# The kinds that an endpoint of a topic has to find.
OPPOSITE: Final[Mapping[Kind, tuple[Kind, ...]]] = {
    'publisher': ('subscription', 'polled', 'recorded'),
    'subscription': ('publisher',),
    'polled': ('publisher',),
}


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
