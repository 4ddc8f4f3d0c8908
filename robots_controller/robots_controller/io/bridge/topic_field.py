"""TopicField: a number inside the messages of a ROS topic, as a row of an I/O map names it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from robots_controller.io.bridge.io_port import Place
from robots_controller.io.field_path import FieldPath
from robots_core.cell_interface.topic_qos import Profile
from robots_core.files.yaml_section import YamlSection

KEYS: Final = ('topic', 'type', 'field', 'qos')

STD_TYPES: Final = (
    *('Bool', 'Int8', 'Int16', 'Int32', 'Int64', 'UInt8', 'UInt16', 'UInt32', 'UInt64', 'Float32', 'Float64'),
    *(f'{kind}{size}MultiArray' for kind in ('Int', 'UInt') for size in (8, 16, 32, 64)),
    *('Float32MultiArray', 'Float64MultiArray'),
)
"""Types that are written without their package, std_msgs."""

# As in ROS, the defaults first.
RELIABILITIES: Final = ('reliable', 'best_effort')
DURABILITIES: Final = ('volatile', 'transient_local')
DEFAULT_QOS: Final = Profile('', '', depth=10)


@dataclass(frozen=True)
class TopicField(Place):
    """A field of an external topic, its `port`.

    Attributes:
        type: The topic's type, as package/msg/Name.
        path: The field.
        qos: Of the topic.
    """

    type: str
    path: FieldPath
    qos: Profile = DEFAULT_QOS

    @property
    def text(self) -> str:
        """The field."""
        return self.path.text


def read_topic_field(item: YamlSection) -> TopicField:
    """The keys `topic`, `type`, `field` and `qos` of a row.

    Raises:
        InvalidInputError: one of them is missing or not valid; with file and line.
    """
    topic, kind = _topic(item), _type(item)
    path = item.checked(lambda: FieldPath.parse(item.text('field', 'data')), 'field')
    return TopicField(topic, kind, path, _qos(item))


def _topic(item: YamlSection) -> str:
    topic = item.text('topic')
    parts = topic.removeprefix('/').removeprefix('~/').split('/')
    if not all(part.isidentifier() and part.isascii() for part in parts):
        raise item.error(f'{topic!r} is no topic; topics are like plc/inputs or /plc/inputs', 'topic')
    return topic


def _type(item: YamlSection) -> str:
    text = item.text('type')
    if text in STD_TYPES:
        return f'std_msgs/msg/{text}'
    parts = text.split('/')
    if len(parts) == 2:
        parts.insert(1, 'msg')
    if len(parts) != 3 or parts[1] != 'msg' or not all(part.isidentifier() for part in parts):
        raise item.error(
            f'{text!r} is no message type; types are package/msg/Name or one of {", ".join(STD_TYPES)}',
            'type',
        )
    return '/'.join(parts)


def _qos(item: YamlSection) -> Profile:
    section = item.section('qos')
    if section is None:
        return DEFAULT_QOS
    reliability = section.text('reliability', RELIABILITIES[0], among=RELIABILITIES)
    durability = section.text('durability', DURABILITIES[0], among=DURABILITIES)
    depth = section.whole('depth', DEFAULT_QOS.depth, low=1, high=1000)
    return Profile('', '', depth, reliability == RELIABILITIES[0], durability != DURABILITIES[0])
