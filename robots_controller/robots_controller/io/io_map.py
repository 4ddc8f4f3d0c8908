"""IoMap: which channel of the robot is which field of a topic or value of a plant, read from YAML."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_controller.io.bridge.io_port import Place, PlantPlace
from robots_controller.io.bridge.topic_field import KEYS as TOPIC_KEYS
from robots_controller.io.bridge.topic_field import TopicField, read_topic_field
from robots_controller.io.channel_declarations import ChannelDeclarations, read_declarations
from robots_controller.io.fail_safe import fail_safe_of
from robots_controller.io.io_image import Channel, Direction
from robots_controller.io.io_signals import channel_at, value_at
from robots_controller.io.number_kinds import INTEGERS, bits_of
from robots_controller.io.plant.protocols import PROTOCOLS, PlantServer, read_plant_place, read_servers
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection, located, read_yaml

HIGHEST_BIT: Final = 63
LONGEST_TIME: Final = 3600.0  # s

SHORTEST_OUTPUT_TIMEOUT: Final = 0.2  # s, twice the time between two images of a robot program's node
OUTPUT_TIMEOUT: Final = 0.5  # s, where the map names none

_KEYS: Final = (
    *('channel', 'bit', 'bits', *TOPIC_KEYS, 'scale', 'offset', 'invert', 'debounce', 'timeout'),
    *('fail_safe', 'period', *PROTOCOLS),
)


@dataclass(frozen=True)
class IoRow:
    """One channel and its place at a partner: a field of a topic, a register, a variable.

    Attributes:
        bit: Bit of a whole number, counted from 0; None for the whole field.
        scale: Of an analog channel: to = scale * from + offset, in the direction the value travels.
        debounce: How long a digital input must have its value before it counts, s.
        timeout: After how long without a message (of an output: without an image of the outputs) the
            fail-safe value takes over, s; infinite for never.
        fail_safe: The input's value then; those of outputs are in `IoMap.fail_safe`.
        period: How often an output is repeated without a change, s; infinite for never.
    """

    channel: Channel
    place: Place
    bit: int | None = None
    scale: float = 1.0
    offset: float = 0.0
    invert: bool = False
    debounce: float = 0.0
    timeout: float = math.inf
    fail_safe: float = 0.0
    period: float = math.inf
    file: str = ''
    line: int = 0

    def error(self, message: str) -> InvalidInputError:
        """An error at this row."""
        return located(self.file, self.line, message)


@dataclass(frozen=True)
class IoMap(ChannelDeclarations):
    """All rows of a file, and its declarations: those of its rows too.

    Attributes:
        inputs: What becomes inputs.
        outputs: What outputs become.
        servers: The servers of protocols, by `Place.port`.
    """

    inputs: tuple[IoRow, ...] = ()
    outputs: tuple[IoRow, ...] = ()
    servers: Mapping[str, PlantServer] = field(default_factory=lambda: MappingProxyType({}))

    def check_simulated_time(self) -> None:
        """Check that the map works where time is simulated.

        Raises:
            InvalidInputError: it has servers, which time does not wait for.
        """
        for row in (*self.inputs, *self.outputs):
            if row.place.port in self.servers:
                raise row.error(f'{row.place.port} is not connected in lock-step; topics are')


def read_io_map(path: Path | str) -> IoMap:
    """The map of a file.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    section = read_yaml(path)
    declared = read_declarations(section)
    safe = dict(declared.fail_safe)
    known = _Known(declared.signals, safe, MappingProxyType(read_servers(section)))
    inputs = [row for item in section.sections('inputs') for row in _rows(item, 'input', known)]
    outputs = [row for item in section.sections('outputs') for row in _rows(item, 'output', known)]
    section.finish()
    _check_channels(inputs)
    _check_outputs(outputs)
    _check_topics([*inputs, *outputs])
    if not (inputs or outputs):
        raise section.error('the file maps nothing; it needs rows below inputs or outputs')
    declared = replace(declared, fail_safe=MappingProxyType(safe))
    return IoMap(tuple(inputs), tuple(outputs), known.servers, **vars(declared))


@dataclass(frozen=True)
class _Known:
    """What a file says before its rows; the fail-safe values in the rows are added."""

    signals: Mapping[str, Channel]
    safe: dict[str, float | None]
    servers: Mapping[str, PlantServer]


def _rows(item: YamlSection, direction: Direction, known: _Known) -> list[IoRow]:
    """The row of an item, or one for each of its bits."""
    bits = item.section('bits')
    channels: list[tuple[Channel, int | None, int]] = []
    if bits is None:
        channel = _channel(item, 'channel', direction, known.signals)
        bit = item.whole('bit', low=0, high=HIGHEST_BIT) if 'bit' in item else None
        channels.append((channel, bit, item.line))
    else:
        for key in ('channel', 'bit'):
            if key in item:
                raise item.error(f'{key} and bits exclude each other', key)
        for key in bits.keys:
            if not key.isdecimal() or int(key) > HIGHEST_BIT:
                raise bits.error(f'bit {key!r} is no whole number in 0..{HIGHEST_BIT}', key)
            channels.append((_channel(bits, key, direction, known.signals), int(key), bits.line_of(key)))
        if not channels:
            raise item.error('bits names no channel', 'bits')
    rows = [_row(item, channel, bit, line, known) for channel, bit, line in channels]
    if direction == 'output' and 'fail_safe' in item:
        for row in rows:
            _declare(item, row, known.safe)
    item.finish(_KEYS)
    return rows


def _channel(section: YamlSection, key: str, direction: Direction, signals: Mapping[str, Channel]) -> Channel:
    channel = channel_at(section, section.text(key), section.line_of(key), signals)
    if channel.direction != direction:
        raise section.error(f'{channel.name} stands below {direction}s', key)
    return channel


def _row(item: YamlSection, channel: Channel, bit: int | None, line: int, known: _Known) -> IoRow:
    digital = channel.kind == 'digital'
    if bit is not None and not digital:
        raise item.error(f'{channel.name} cannot be one bit', 'bit')
    for key in ('scale', 'offset') if digital else ('invert', 'debounce'):
        if key in item:
            raise item.error(f'{key} is not for {channel.kind} channels, {channel.name} is one', key)
    plant = read_plant_place(item, channel, known.servers)
    place, polling = (read_topic_field(item), None) if plant is None else (plant[0], plant[1].period)
    if isinstance(place, PlantPlace):  # the type of a topic's field is checked where its message is known
        item.checked(partial(check_bit, place, bit, place.kind), 'bit')
    unfit = 'debounce' if channel.direction == 'output' else '' if polling else 'period'
    if unfit in item:
        raise item.error(f'{unfit} is not for {channel.direction}s', unfit)
    timed = channel.direction == 'input' and 'timeout' in item
    if channel.direction == 'input' and timed != ('fail_safe' in item):
        raise item.error('timeout and fail_safe need each other', 'timeout' if timed else 'fail_safe')
    period = polling if polling and channel.direction == 'input' else math.inf
    period = item.number('period', period, low=0.001, high=LONGEST_TIME) if 'period' in item else period
    timeout = _timeout(item, channel)
    if timed and polling and timeout <= period:
        raise item.error(f'timeout is {timeout:g} s; valid is more than the period, {period:g} s', 'timeout')
    scale = 1.0 if digital else item.number('scale', 1.0)
    if scale == 0.0:
        raise item.error('scale is 0; valid is any other finite number', 'scale')
    return IoRow(
        channel=channel,
        place=place,
        bit=bit,
        scale=scale,
        offset=0.0 if digital else item.number('offset', 0.0),
        invert=digital and item.switch('invert', default=False),
        debounce=item.number('debounce', 0.0, low=0.0, high=LONGEST_TIME) if 'debounce' in item else 0.0,
        timeout=timeout,
        fail_safe=value_at(item, 'fail_safe', channel) if timed else 0.0,
        period=period,
        file=item.file,
        line=line,
    )


def check_bit(place: Place, bit: int | None, kind: str) -> None:
    """Check that a place whose number is of a kind has a bit; None for no bit.

    Raises:
        InvalidInputError: it has not.
    """
    if bit is None:
        return
    if kind not in INTEGERS:
        raise InvalidInputError(f'{place.text} is {kind!r}; a bit needs a whole number')
    if bit >= (bits := bits_of(kind)):
        raise InvalidInputError(f'{place.text} is {kind!r} with bits 0..{bits - 1}, not {bit}')


def _timeout(item: YamlSection, channel: Channel) -> float:
    if channel.direction == 'output':
        return item.number('timeout', OUTPUT_TIMEOUT, low=SHORTEST_OUTPUT_TIMEOUT, high=LONGEST_TIME)
    return item.number('timeout', low=0.001, high=LONGEST_TIME) if 'timeout' in item else math.inf


def _declare(item: YamlSection, row: IoRow, safe: dict[str, float | None]) -> None:
    """Take the fail-safe value of an output; it has one, however many topics it goes to."""
    value, name = fail_safe_of(item, 'fail_safe', row.channel), row.channel.name
    if safe.setdefault(name, value) != value:
        raise row.error(f'{name} has another fail-safe value already; an output has one')


def _check_channels(inputs: list[IoRow]) -> None:
    seen: dict[Channel, IoRow] = {}
    for row in inputs:
        if row.channel in seen:
            raise row.error(f'{row.channel.name} is mapped in line {seen[row.channel].line} already')
        seen[row.channel] = row


def _check_outputs(outputs: list[IoRow]) -> None:
    seen: dict[tuple[str, str], list[IoRow]] = {}
    for row in outputs:
        for cell in row.place.cells:
            there = seen.setdefault((row.place.port, cell), [])
            for other in there:
                if row.place != other.place or None in (row.bit, other.bit) or row.bit == other.bit:
                    where = row.place.text if row.bit is None else f'bit {row.bit} of {row.place.text}'
                    raise row.error(f'{where} of {row.place.port} is set in line {other.line} already')
            there.append(row)


def _check_topics(rows: list[IoRow]) -> None:
    seen: dict[tuple[str, str], tuple[IoRow, TopicField]] = {}
    for row in rows:
        if not isinstance(here := row.place, TopicField):
            continue
        first, there = seen.setdefault((here.port, row.channel.direction), (row, here))
        if here.type != there.type:
            raise row.error(f'{here.port} is a {here.type} here and a {there.type} in line {first.line}')
        if here.qos != there.qos:
            raise row.error(f'{here.port} has another qos here than in line {first.line}')
    for (topic, direction), (row, _) in seen.items():
        if direction == 'output' and (topic, 'input') in seen:
            line = seen[topic, 'input'][0].line
            raise row.error(f'{topic} is an input in line {line}; the bridge would receive its own messages')
