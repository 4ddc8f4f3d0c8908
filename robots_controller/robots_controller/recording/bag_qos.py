"""Quality of service as bags record it."""

from typing import Final

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

from robots_core.cell_interface.topic_qos import topic_qos

UNLIMITED: Final = QosTime(sec=2147483647, nsec=4294967295)


def bag_qos(*, latched: bool, reliable: bool = True, depth: int = 1) -> Qos:
    """The profile of a publisher; see `Profile`."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=max(1, depth),
        reliability=QosReliability.RELIABLE if reliable else QosReliability.BEST_EFFORT,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=UNLIMITED,
        lifespan=UNLIMITED,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=UNLIMITED,
        avoid_ros_namespace_conventions=False,
    )


def bag_qos_of(topic: str) -> Qos:
    """The profile of the publishers of a topic of the suite.

    Raises:
        InvalidInputError: it is none of the suite.
    """
    profile = topic_qos(topic).published
    return bag_qos(latched=profile.latched, reliable=profile.reliable, depth=profile.depth)
