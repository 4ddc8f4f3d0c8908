"""BagTopic: what a bag says of a topic."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from rosbags.interfaces import Qos, QosDurability


@dataclass(frozen=True)
class BagTopic:
    """A topic of a bag.

    Attributes:
        name: Its full name.
        type: package/msg/Name.
        latched: Its publishers latch: late subscribers get the last message.
        definition: Text of the message definition, '' where the bag has none.
        definition_format: Of the text: 'msg' or 'idl'.
    """

    name: str
    type: str
    latched: bool
    definition: str = field(repr=False, default='')
    definition_format: str = 'msg'


def latched(profiles: Sequence[Qos]) -> bool:
    """All publishers with these profiles latch."""
    return bool(profiles) and all(p.durability is QosDurability.TRANSIENT_LOCAL for p in profiles)
