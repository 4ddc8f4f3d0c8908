"""TopicField: a number inside the messages of a ROS topic, as a row of an I/O map names it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

from robots_controller.io.bridge.io_port import Place
from robots_core.cell_interface.topic_qos import Profile
from robots_core.errors import InvalidInputError
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

_NAME: Final = '[A-Za-z_][A-Za-z0-9_]*'
_PATH: Final = re.compile(rf'{_NAME}(\.{_NAME}|\[[0-9]{{1,6}}\])*')
_STEP: Final = re.compile(rf'({_NAME})|\[([0-9]+)\]')


@dataclass(frozen=True)
class FieldPath:
    """Where a value stands in a message: `data[2]`, `pose.position.x`.

    Attributes:
        text: As it was written.
        steps: Names of fields and indices (from 0, as in the message) from the outside in.
    """

    text: str
    steps: tuple[str | int, ...]

    @classmethod
    def parse(cls, text: str) -> FieldPath:
        """The path of a text.

        Raises:
            InvalidInputError: not a path.
        """
        if not _PATH.fullmatch(text):
            raise InvalidInputError(
                f'{text!r} is no path of a field; paths are like data, data[2] or pose.position.x'
            )
        return cls(text, tuple(name or int(index) for name, index in _STEP.findall(text)))

    def get(self, message: Any) -> Any:
        """The value in a message, whose type has the field.

        Raises:
            InvalidInputError: an array of the message is too short.
        """
        value = message
        for depth, step in enumerate(self.steps):
            if isinstance(step, str):
                value = getattr(value, step)
            elif step < len(value):
                value = value[step]
            else:
                raise InvalidInputError(
                    f'{self.up_to(depth)} has {len(value)} elements; {self.text} needs {step + 1}'
                )
        return value

    def set(self, message: Any, value: float) -> None:
        """Set the value in a message that has the place; see `make_room`."""
        *outer, last = self.steps
        holder = FieldPath(self.text, tuple(outer)).get(message)
        if isinstance(last, int):
            holder[last] = value
        else:
            setattr(holder, last, value)

    def up_to(self, depth: int) -> str:
        """The text of the first steps."""
        text = ''.join(f'[{step}]' if isinstance(step, int) else f'.{step}' for step in self.steps[:depth])
        return text.removeprefix('.')


@dataclass(frozen=True)
class TopicField(Place):
    """A field of an external topic, its `port`.

    Attributes:
        type: The topic's type, as package/msg/Name.
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
