"""IoMap: which channel of the robot is which field of which external topic, read from YAML."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_controller.io.channel_declarations import ChannelDeclarations, read_declarations
from robots_controller.io.fail_safe import fail_safe_of
from robots_controller.io.field_path import FieldPath
from robots_controller.io.io_image import Channel, Direction
from robots_controller.io.io_signals import channel_at, value_at
from robots_core.errors import InvalidInputError
from robots_core.files import read_text
from robots_core.yaml_section import YamlSection, located, parse_yaml

HIGHEST_BIT: Final = 63
LONGEST_TIME: Final = 3600.0  # s

STD_TYPES: Final = (
    *('Bool', 'Int8', 'Int16', 'Int32', 'Int64', 'UInt8', 'UInt16', 'UInt32', 'UInt64', 'Float32', 'Float64'),
    *(f'{kind}{size}MultiArray' for kind in ('Int', 'UInt') for size in (8, 16, 32, 64)),
    *('Float32MultiArray', 'Float64MultiArray'),
)
"""Types that are written without their package, std_msgs."""

SHORTEST_OUTPUT_TIMEOUT: Final = 0.2  # s, twice the time between two images of a robot program's node
OUTPUT_TIMEOUT: Final = 0.5  # s, where the map names none

_KEYS: Final = (
    *('channel', 'bit', 'bits', 'topic', 'type', 'field', 'scale', 'offset', 'invert', 'debounce', 'timeout'),
    *('fail_safe', 'period', 'qos'),
)


# As in ROS, the defaults first.
RELIABILITIES: Final = ('reliable', 'best_effort')
DURABILITIES: Final = ('volatile', 'transient_local')


@dataclass(frozen=True)
class TopicQos:
    """Quality of service of an external topic."""

    reliability: str = RELIABILITIES[0]
    durability: str = DURABILITIES[0]
    depth: int = 10


@dataclass(frozen=True)
class IoRow:
    """One channel and its place in an external topic.

    Attributes:
        channel: The robot's channel.
        topic: The external topic.
        type: Its type, as package/msg/Name.
        path: The field.
        bit: Bit of a whole number, counted from 0; None for the whole field.
        scale: Of an analog channel: to = scale * from + offset, in the direction the value travels.
        offset: As above.
        invert: Of a digital channel.
        debounce: How long a digital input must have its value before it counts, s.
        timeout: After how long without a message (of an output: without an image of the outputs) the
            fail-safe value takes over, s; infinite for never.
        fail_safe: The input's value then; those of outputs are in `IoMap.fail_safe`.
        period: How often an output is repeated without a change, s; infinite for never.
        qos: Of the topic.
        file: Where the row stands.
        line: Its line.
    """

    channel: Channel
    topic: str
    type: str
    path: FieldPath
    bit: int | None = None
    scale: float = 1.0
    offset: float = 0.0
    invert: bool = False
    debounce: float = 0.0
    timeout: float = math.inf
    fail_safe: float = 0.0
    period: float = math.inf
    qos: TopicQos = field(default_factory=TopicQos)
    file: str = ''
    line: int = 0

    def error(self, message: str) -> InvalidInputError:
        """An error at this row."""
        return located(self.file, self.line, message)


@dataclass(frozen=True)
class IoMap(ChannelDeclarations):
    """All rows of a file, and its declarations: those of its rows too.

    Attributes:
        inputs: Topics to inputs.
        outputs: Outputs to topics.
    """

    inputs: tuple[IoRow, ...] = ()
    outputs: tuple[IoRow, ...] = ()


def read_io_map(path: Path | str) -> IoMap:
    """The map of a file.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    return parse_io_map(read_text(path), Path(path).name)


def parse_io_map(text: str, file: str = 'io_map.yaml') -> IoMap:
    """The map of a YAML text.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    section = parse_yaml(text, file)
    declared = read_declarations(section)
    signals, safe = declared.signals, dict(declared.fail_safe)
    inputs = [row for item in section.sections('inputs') for row in _rows(item, 'input', signals, safe)]
    outputs = [row for item in section.sections('outputs') for row in _rows(item, 'output', signals, safe)]
    section.finish()
    _check_channels(inputs)
    _check_outputs(outputs)
    _check_topics([*inputs, *outputs])
    if not (inputs or outputs):
        raise section.error('the file maps nothing; it needs rows below inputs or outputs')
    declared = replace(declared, fail_safe=MappingProxyType(safe))
    return IoMap(tuple(inputs), tuple(outputs), **vars(declared))


def _rows(
    item: YamlSection,
    direction: Direction,
    signals: Mapping[str, Channel],
    safe: dict[str, float | None],
) -> list[IoRow]:
    """The row of an item, or one for each of its bits; the fail-safe values of outputs go to `safe`."""
    bits = item.section('bits')
    channels: list[tuple[Channel, int | None, int]] = []
    if bits is None:
        channel = _channel(item, 'channel', direction, signals)
        bit = item.whole('bit', low=0, high=HIGHEST_BIT) if 'bit' in item else None
        channels.append((channel, bit, item.line))
    else:
        for key in ('channel', 'bit'):
            if key in item:
                raise item.error(f'{key} and bits exclude each other', key)
        for key in bits.keys:
            if not key.isdecimal() or int(key) > HIGHEST_BIT:
                raise bits.error(f'bit {key!r} is no whole number in 0..{HIGHEST_BIT}', key)
            channels.append((_channel(bits, key, direction, signals), int(key), bits.line_of(key)))
        if not channels:
            raise item.error('bits names no channel', 'bits')
    rows = [_row(item, channel, bit, line) for channel, bit, line in channels]
    if direction == 'output' and 'fail_safe' in item:
        for row in rows:
            _declare(item, row, safe)
    item.finish(_KEYS)
    return rows


def _channel(section: YamlSection, key: str, direction: Direction, signals: Mapping[str, Channel]) -> Channel:
    channel = channel_at(section, section.text(key), section.line_of(key), signals)
    if channel.direction != direction:
        raise section.error(f'{channel.name} stands below {direction}s', key)
    return channel


def _row(item: YamlSection, channel: Channel, bit: int | None, line: int) -> IoRow:
    digital = channel.kind == 'digital'
    if bit is not None and not digital:
        raise item.error(f'{channel.name} cannot be one bit', 'bit')
    for key in ('scale', 'offset') if digital else ('invert', 'debounce'):
        if key in item:
            raise item.error(f'{key} is not for {channel.kind} channels, {channel.name} is one', key)
    for key in ('period',) if channel.direction == 'input' else ('debounce',):
        if key in item:
            raise item.error(f'{key} is not for {channel.direction}s', key)
    timed = channel.direction == 'input' and 'timeout' in item
    if channel.direction == 'input' and timed != ('fail_safe' in item):
        raise item.error('timeout and fail_safe need each other', 'timeout' if timed else 'fail_safe')
    scale = 1.0 if digital else item.number('scale', 1.0)
    if scale == 0.0:
        raise item.error('scale is 0; valid is any other finite number', 'scale')
    return IoRow(
        channel=channel,
        topic=_topic(item),
        type=_type(item),
        path=_path(item),
        bit=bit,
        scale=scale,
        offset=0.0 if digital else item.number('offset', 0.0),
        invert=digital and item.switch('invert', default=False),
        debounce=item.number('debounce', 0.0, low=0.0, high=LONGEST_TIME) if 'debounce' in item else 0.0,
        timeout=_timeout(item, channel),
        fail_safe=value_at(item, 'fail_safe', channel) if timed else 0.0,
        period=item.number('period', low=0.001, high=LONGEST_TIME) if 'period' in item else math.inf,
        qos=_qos(item),
        file=item.file,
        line=line,
    )


def _timeout(item: YamlSection, channel: Channel) -> float:
    if channel.direction == 'output':
        return item.number('timeout', OUTPUT_TIMEOUT, low=SHORTEST_OUTPUT_TIMEOUT, high=LONGEST_TIME)
    return item.number('timeout', low=0.001, high=LONGEST_TIME) if 'timeout' in item else math.inf


def _declare(item: YamlSection, row: IoRow, safe: dict[str, float | None]) -> None:
    """Take the fail-safe value of an output; it has one, however many topics it goes to."""
    value, name = fail_safe_of(item, 'fail_safe', row.channel), row.channel.name
    if safe.setdefault(name, value) != value:
        raise row.error(f'{name} has another fail-safe value already; an output has one')


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


def _path(item: YamlSection) -> FieldPath:
    try:
        return FieldPath.parse(item.text('field', 'data'))
    except InvalidInputError as error:
        raise item.error(error.message, 'field') from None


def _qos(item: YamlSection) -> TopicQos:
    section = item.section('qos')
    if section is None:
        return TopicQos()
    qos = TopicQos(
        section.text('reliability', RELIABILITIES[0], among=RELIABILITIES),
        section.text('durability', DURABILITIES[0], among=DURABILITIES),
        section.whole('depth', 10, low=1, high=1000),
    )
    section.finish()
    return qos


def _check_channels(inputs: list[IoRow]) -> None:
    seen: dict[Channel, IoRow] = {}
    for row in inputs:
        if row.channel in seen:
            raise row.error(f'{row.channel.name} is mapped in line {seen[row.channel].line} already')
        seen[row.channel] = row


def _check_outputs(outputs: list[IoRow]) -> None:
    seen: dict[tuple[str, str], list[IoRow]] = {}
    for row in outputs:
        place = (row.topic, row.path.text)
        for other in seen.get(place, ()):
            if row.bit is None or other.bit is None or row.bit == other.bit:
                where = row.path.text if row.bit is None else f'bit {row.bit} of {row.path.text}'
                raise row.error(f'{where} of {row.topic} is set in line {other.line} already')
        seen.setdefault(place, []).append(row)


def _check_topics(rows: list[IoRow]) -> None:
    seen: dict[tuple[str, str], IoRow] = {}
    for row in rows:
        first = seen.setdefault((row.topic, row.channel.direction), row)
        if row.type != first.type:
            raise row.error(f'{row.topic} is a {row.type} here and a {first.type} in line {first.line}')
        if row.qos != first.qos:
            raise row.error(f'{row.topic} has another qos here than in line {first.line}')
    both = [(topic, row) for (topic, direction), row in seen.items() if direction == 'output']
    for topic, row in both:
        if other := seen.get((topic, 'input')):
            raise row.error(f'{topic} is an input in line {other.line}; the bridge would hear itself')
