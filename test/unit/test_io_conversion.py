"""Values between channels and messages."""

from __future__ import annotations

import math
from typing import Any

import pytest

from robots_controller.io.bridge.topic_field import FieldPath, TopicField
from robots_controller.io.io_conversion import InputValue, from_field, to_field
from robots_controller.io.io_map import IoRow
from robots_controller.io.io_signals import parse_channel
from robots_core.errors import InvalidInputError


def row(channel: str, **options: Any) -> IoRow:
    place = TopicField('plc/a', 'std_msgs/msg/UInt16', FieldPath.parse('data'))
    return IoRow(parse_channel(channel, {}), place, **options)


@pytest.mark.parametrize(
    ('raw', 'options', 'value'),
    [
        (True, {}, 1.0),
        (255, {}, 1.0),
        (-1, {}, 1.0),
        (0.0, {}, 0.0),
        (0, {'invert': True}, 1.0),
        (0b1000, {'bit': 3}, 1.0),
        (0b0111, {'bit': 3}, 0.0),
        (-32768, {'bit': 15}, 1.0),
        (0b1000, {'bit': 3, 'invert': True}, 0.0),
    ],
)
def test_a_digital_input(raw: object, options: dict[str, Any], value: float):
    assert from_field(row('digital_input.1', **options), raw) == value


def test_an_analog_input_is_scaled():
    assert from_field(row('analog_input.1', scale=0.5, offset=-1.0), 7) == 2.5
    assert from_field(row('analog_input.1', scale=0.5), True) == 0.5


@pytest.mark.parametrize(
    ('raw', 'options', 'problem'),
    [
        (math.nan, {}, 'data is nan; needed is a finite number'),
        ('text', {}, "data is 'text'; needed is a number"),
        ([1], {}, 'needed is a number'),
        (1.5, {'bit': 0}, 'a bit needs a whole number'),
    ],
)
def test_what_is_no_value_is_reported(raw: object, options: dict[str, Any], problem: str):
    with pytest.raises(InvalidInputError, match=problem):
        from_field(row('digital_input.1', **options), raw)


def test_a_value_that_overflows_is_reported():
    with pytest.raises(InvalidInputError, match='it is no finite number'):
        from_field(row('analog_input.1', scale=1e300), 1e300)


def test_a_value_counts_once_it_has_lasted():
    value = InputValue(row('digital_input.1', debounce=0.1), 0.0)
    value.receive(0, 0.0)
    value.receive(1, 1.0)
    assert value.update(1.09) == 0.0
    assert value.next_time(1.09) == 1.1
    assert value.update(1.1) == 1.0
    assert value.next_time(1.1) == math.inf


def test_a_bounce_begins_the_wait_anew():
    value = InputValue(row('digital_input.1', debounce=0.125), 0.0)
    for time, raw in ((0.0, 0), (1.0, 1), (1.0625, 0), (1.125, 1)):
        value.receive(raw, time)
    assert value.update(1.2499) == 0.0
    assert value.update(1.25) == 1.0


def test_a_value_that_lasts_through_many_messages_is_not_delayed():
    value = InputValue(row('digital_input.1', debounce=0.1), 0.0)
    value.receive(0, 0.0)
    for k in range(11):
        value.receive(1, 1.0 + 0.01 * k)
    assert value.update(1.1) == 1.0


def test_silence_leads_to_the_fail_safe_value_and_the_first_message_back():
    value = InputValue(row('digital_input.1', timeout=0.5, fail_safe=1.0, debounce=0.1), 0.0)
    assert value.update(0.0) == 1.0
    value.receive(0, 0.1)
    assert value.update(0.59) == 0.0
    assert value.next_time(0.59) == 0.6
    assert not value.silent(0.59)
    assert value.update(0.6) == 1.0
    assert value.silent(0.6)
    assert value.next_time(0.6) == math.inf
    value.receive(0, 2.0)
    assert value.update(2.0) == 0.0


def test_a_message_without_a_value_does_not_end_the_silence():
    value = InputValue(row('digital_input.1', timeout=0.5), 0.0)
    with pytest.raises(InvalidInputError):
        value.receive(math.nan, 0.4)
    assert value.silent(0.5)


@pytest.mark.parametrize(
    ('case', 'field', 'problem'),
    [
        (('digital_output.1', {}, 1.0, ('boolean', False)), True, ''),
        (('digital_output.1', {'invert': True}, 1.0, ('uint8', 1)), 0, ''),
        (('digital_output.1', {}, 1.0, ('double', 0.0)), 1.0, ''),
        (('digital_output.1', {'bit': 3}, 1.0, ('uint16', 0b0101)), 0b1101, ''),
        (('digital_output.1', {'bit': 2}, 0.0, ('uint16', 0b0101)), 0b0001, ''),
        (('digital_output.1', {'bit': 15}, 1.0, ('int16', 1)), -32767, ''),
        (('digital_output.1', {'bit': 15}, 0.0, ('int16', -32767)), 1, ''),
        (('analog_output.1', {'scale': 409.5}, 10.0, ('uint16', 0)), 4095, ''),
        (('analog_output.1', {}, 2.6, ('int8', 0)), 3, ''),
        (
            ('analog_output.1', {}, 300.0, ('uint8', 0)),
            255,
            'analog_output.1 would be 300; uint8 ends at 255',
        ),
        (('analog_output.1', {}, -1.0, ('uint8', 0)), 0, 'analog_output.1 would be -1; uint8 ends at 0'),
        (
            ('analog_output.1', {'scale': 1e300}, 1e300, ('int64', 0)),
            2**63 - 1,
            'analog_output.1 would be inf',
        ),
        (
            ('analog_output.1', {}, 1e39, ('float', 0.0)),
            3.4028234663852886e38,
            'analog_output.1 would be 1e+39',
        ),
        (('analog_output.1', {'scale': 2.0, 'offset': 1.0}, 0.25, ('double', 0.0)), 1.5, ''),
    ],
)
def test_an_output(case: tuple[str, dict[str, Any], float, tuple[str, Any]], field: Any, problem: str):
    channel, options, value, (kind, before) = case
    found, told = to_field(row(channel, **options), value, kind, before)
    assert found == field
    assert type(found) is type(field)
    assert told.startswith(problem)
    assert bool(told) == bool(problem)
