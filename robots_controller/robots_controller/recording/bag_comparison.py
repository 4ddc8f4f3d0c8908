"""Compares a recorded bag with the expected one: the first difference of every topic."""

import bisect
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from robots_controller.recording.bag_file import Bag
from robots_controller.recording.bag_tolerances import BagTolerances, TopicTolerance
from robots_core.errors import BagError

Value = bool | int | float | str | bytes
Fields = dict[str, Value]


@dataclass(frozen=True)
class Difference:
    """Where two bags first differ.

    Attributes:
        topic: The topic.
        time: In the expected bag, s from time zero; of a message that is too much, in the recorded one.
        field: Path in the message; '' for a message that is missing, too much, too early or too late.
        expected: What the field, or the topic, should be.
        recorded: What it is.
    """

    topic: str
    time: float
    field: str
    expected: str
    recorded: str

    def __str__(self) -> str:
        place = f'{self.topic} at {self.time:.4f} s' + (f', {self.field}' if self.field else '')
        return f'{place}: expected {self.expected}, recorded {self.recorded}'


@dataclass(frozen=True)
class TopicResult:
    """Comparison of one topic.

    Attributes:
        topic: Its name.
        expected: Number of messages that were compared.
        recorded: The same in the recorded bag.
        difference: The first one; None if there is none.
    """

    topic: str
    expected: int
    recorded: int
    difference: Difference | None


@dataclass(frozen=True)
class Comparison:
    """Comparison of two bags, topic by topic.

    Attributes:
        topics: Of the expected bag, in order of name, without those that are ignored.
        unexpected: Topics of the recorded bag alone; they do not count.
        unknown: Topics of types that are not defined, whose messages were compared byte by byte.
    """

    topics: tuple[TopicResult, ...]
    unexpected: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """No difference."""
        return self.first is None

    @property
    def first(self) -> Difference | None:
        """The earliest difference of all topics."""
        found = [result.difference for result in self.topics if result.difference]
        return min(found, key=lambda difference: difference.time, default=None)

    def describe(self) -> str:
        """For a person: the first difference, then those of the other topics."""
        count = sum(result.expected for result in self.topics)
        if self.first is None:
            return f'{len(self.topics)} topics with {count} messages agree'
        lines = [f'first difference: {self.first}']
        lines += [
            f'also: {result.difference}'
            for result in self.topics
            if result.difference and result.difference is not self.first
        ]
        same = [result.topic for result in self.topics if not result.difference]
        return '\n'.join([*lines, f'{len(same)} of {len(self.topics)} topics agree'])

    def junit(self, name: str) -> str:
        """The result as JUnit XML, a test case for each topic."""
        failures = sum(result.difference is not None for result in self.topics)
        suite = ET.Element('testsuite', name=name, tests=str(len(self.topics)), failures=str(failures))
        for result in self.topics:
            case = ET.SubElement(suite, 'testcase', classname=name, name=result.topic)
            if result.difference:
                text = _xml_text(str(result.difference))
                ET.SubElement(case, 'failure', message=text).text = text
        return ET.tostring(suite, encoding='unicode', xml_declaration=True)


def compare_bags(recorded: Bag, expected: Bag, tolerances: BagTolerances | None = None) -> Comparison:
    """Compare all topics of the expected bag.

    Times count from time zero, the first message of the topic `align`, in each bag. What latched topics
    said before is their state at time zero, and only the last of it counts.

    Raises:
        RobotsError: nothing to compare, the topic to align by is missing, or messages that cannot be read.
    """
    tolerances = tolerances or BagTolerances()
    per_topic = _compared(expected, tolerances)
    if not per_topic:
        raise BagError(f'{expected.path} has no topic to compare')
    zero = {bag.path: _zero(bag, per_topic, tolerances.align) for bag in (expected, recorded)}
    both = expected, recorded
    unknown = [t for t in per_topic if not all(bag.defines(t) for bag in both if t in bag.topics)]
    known = [topic for topic in per_topic if topic not in unknown]
    wanted, found = (
        bag.deserialized(known) | {topic: bag.serialized(topic) for topic in unknown} for bag in both
    )
    results = []
    for topic, tolerance in per_topic.items():
        latched = expected.topics[topic].latched
        should = _prime(_timed(wanted[topic], zero[expected.path]), latched=latched)
        is_ = _prime(_timed(found[topic], zero[recorded.path]), latched=latched)
        difference = _type_difference(topic, recorded, expected) or _compare(topic, is_, should, tolerance)
        results.append(TopicResult(topic, len(should), len(is_), difference))
    unexpected = [topic for topic in _compared(recorded, tolerances) if topic not in expected.topics]
    return Comparison(tuple(results), tuple(unexpected), tuple(unknown))


def _compared(bag: Bag, tolerances: BagTolerances) -> dict[str, TopicTolerance]:
    """The topics of a bag that are not ignored, in order of name."""
    found = {name: tolerances.of_topic(name, latched=bag.topics[name].latched) for name in sorted(bag.topics)}
    return {name: tolerance for name, tolerance in found.items() if tolerance.mode != 'ignore'}


@dataclass(frozen=True)
class _Message:
    time: float  # s from time zero; minus infinity for the state at time zero
    fields: Fields


def _zero(bag: Bag, topics: dict[str, TopicTolerance], align: str) -> int:
    if align:
        names = {align, f'/{align}'}
        stamps = [stamp for topic, stamp, _ in bag.messages if topic in names]
        if not stamps:
            raise BagError(f'{bag.path} has no message of {align}, by which the bags are to be aligned')
        return stamps[0]
    compared = [(topic, stamp) for topic, stamp, _ in bag.messages if topic in topics]
    moving = [stamp for topic, stamp in compared if not bag.topics[topic].latched]
    return next(iter(moving or [stamp for _, stamp in compared]), 0)


def _timed(messages: list[tuple[int, Any]], zero: int) -> list[_Message]:
    timed = []
    for stamp, message in messages:
        fields = dict(flat_fields(message))
        # Stamps are of another day in each recording: as times from time zero they can be compared.
        fields |= {
            path: 1e-9 * (value - zero)
            for path, value in fields.items()
            if path.endswith('stamp') and isinstance(value, int) and value
        }
        timed.append(_Message(1e-9 * (stamp - zero), fields))
    return timed


def _prime(messages: list[_Message], *, latched: bool) -> list[_Message]:
    if not latched:
        return messages
    before = [message for message in messages if message.time < 0.0]
    return [_Message(-math.inf, m.fields) for m in before[-1:]] + messages[len(before) :]


def _type_difference(topic: str, recorded: Bag, expected: Bag) -> Difference | None:
    if topic not in recorded.topics:
        return Difference(topic, 0.0, '', 'this topic', 'none')
    types = expected.topics[topic].type, recorded.topics[topic].type
    return None if types[0] == types[1] else Difference(topic, 0.0, '', *types)


def _compare(
    topic: str, recorded: list[_Message], expected: list[_Message], tolerance: TopicTolerance
) -> Difference | None:
    if tolerance.mode == 'samples':
        return _compare_samples(topic, recorded, expected, tolerance)
    if tolerance.mode == 'changes':
        recorded, expected = (_changes(messages, tolerance) for messages in (recorded, expected))
    for is_, should in zip(recorded, expected, strict=False):
        # The state at time zero matches any message in the first moments after it.
        late = max(is_.time, 0.0) - max(should.time, 0.0)
        if difference := _field_difference(topic, is_, should, tolerance):
            return difference
        if abs(late) > tolerance.time:
            return Difference(
                topic,
                max(should.time, 0.0),
                '',
                f'a message within {tolerance.time:g} s',
                f'one {abs(late):.4f} s {"late" if late > 0.0 else "early"}',
            )
    if len(recorded) == len(expected):
        return None
    longer = recorded if len(recorded) > len(expected) else expected
    time = max(longer[min(len(recorded), len(expected))].time, 0.0)
    what = 'changes' if tolerance.mode == 'changes' else 'messages'
    return Difference(topic, time, '', f'{len(expected)} {what}', f'{len(recorded)}')


def _changes(messages: list[_Message], tolerance: TopicTolerance) -> list[_Message]:
    changes: list[_Message] = []
    for message in messages:
        if not changes or _field_difference('', message, changes[-1], tolerance):
            changes.append(message)
    return changes


def _compare_samples(
    topic: str, recorded: Sequence[_Message], expected: Sequence[_Message], tolerance: TopicTolerance
) -> Difference | None:
    times = [message.time for message in recorded]
    for should in expected:
        low = bisect.bisect_left(times, should.time - tolerance.time)
        high = bisect.bisect_right(times, should.time + tolerance.time)
        near = sorted(recorded[low:high], key=lambda message: abs(message.time - should.time))
        if not near:
            return Difference(
                topic, max(should.time, 0.0), '', f'a message within {tolerance.time:g} s', 'none'
            )
        differences = [_field_difference(topic, message, should, tolerance) for message in near]
        if all(differences):
            return differences[0]
    return None


def _field_difference(
    topic: str, recorded: _Message, expected: _Message, tolerance: TopicTolerance
) -> Difference | None:
    for path in dict.fromkeys([*expected.fields, *recorded.fields]):
        allowed = tolerance.of_field(path)
        if allowed is None:
            continue
        should, is_ = expected.fields.get(path), recorded.fields.get(path)
        if path.endswith('stamp') and isinstance(should, float):
            allowed = max(allowed, tolerance.time)
        if not _agree(is_, should, allowed, tolerance.relative):
            return Difference(topic, max(expected.time, 0.0), path, _shown(should), _shown(is_))
    return None


def _agree(recorded: Value | None, expected: Value | None, absolute: float, relative: float) -> bool:
    if isinstance(expected, (int, float)) and isinstance(recorded, (int, float)):
        if recorded == expected or (math.isnan(recorded) and math.isnan(expected)):
            return True
        return abs(recorded - expected) <= max(absolute, relative * abs(expected))
    return recorded == expected


def _shown(value: Value | None) -> str:
    return 'nothing' if value is None else repr(value)


def _xml_text(text: str) -> str:
    """Without the control characters that XML cannot hold."""
    return ''.join(c if c >= ' ' or c in '\n\t' else '\ufffd' for c in text)


def flat_fields(message: Any, path: str = '') -> Iterator[tuple[str, Value]]:
    """All values of a message of rosbags with their paths: `position[2]`, `header.stamp`.

    A time or duration is one value in ns; a list of key-value pairs is written with its keys:
    `values.line`; the length of a list is a value of its own, `position.length`.
    """
    if is_dataclass(message) and not isinstance(message, type):
        values = {name: getattr(message, name) for name in _names(message)}
        if list(values) == ['sec', 'nanosec']:
            yield path, values['sec'] * 1_000_000_000 + values['nanosec']
            return
        for name, value in values.items():
            yield from flat_fields(value, f'{path}.{name}' if path else name)
    elif isinstance(message, (list, tuple, np.ndarray)):
        yield f'{path}.length', len(message)
        if (
            len(message)
            and _names(message[0]) == ['key', 'value']
            and len({pair.key for pair in message}) == len(message)
        ):
            for pair in message:
                yield f'{path}.{pair.key}', pair.value
            return
        for index, item in enumerate(message.tolist() if isinstance(message, np.ndarray) else message):
            yield from flat_fields(item, f'{path}[{index}]')
    else:
        yield path, message


def _names(item: Any) -> list[str]:
    return [field.name for field in fields(item) if field.name[0] != '_'] if is_dataclass(item) else []
