"""Laws of the conversion between channels and messages, and of the scripted PLC."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from read_texts import parse_io_map, parse_plc_script
from robots_controller.io.bridge.topic_field import FieldPath, TopicField
from robots_controller.io.fail_safe import fail_safe_texts, parse_fail_safe, safe_value
from robots_controller.io.io_conversion import InputValue, from_field, to_field
from robots_controller.io.io_image import Channel, IoImage
from robots_controller.io.io_map import IoRow
from robots_controller.io.io_signals import parse_channel
from robots_controller.io.number_kinds import INTEGERS
from robots_controller.io.scripted_plc import InputChange, ScriptedPlc
from robots_core.errors import InvalidInputError


def row(channel: str, **options: Any) -> IoRow:
    return IoRow(parse_channel(channel, {}), TopicField('a', 'b', FieldPath.parse('data')), **options)


@given(st.sampled_from(sorted(INTEGERS)), st.data())
def test_a_bit_comes_back_and_the_others_stay(kind: str, data: st.DataObject):
    low, high = INTEGERS[kind]
    bits = (high - low).bit_length()
    word = data.draw(st.integers(low, high))
    bit = data.draw(st.integers(0, bits - 1))
    on, invert = data.draw(st.booleans()), data.draw(st.booleans())
    field, lost = to_field(row('digital_output.1', bit=bit, invert=invert), float(on), kind, word)
    assert low <= field <= high
    assert not lost
    assert from_field(row('digital_input.1', bit=bit, invert=invert), field) == on
    for other in set(range(bits)) - {bit}:
        same = row('digital_input.1', bit=other)
        assert from_field(same, field) == from_field(same, word)


@given(
    st.sampled_from(sorted(INTEGERS)),
    st.floats(-1e6, 1e6),
    st.floats(0.01, 100.0).flatmap(lambda s: st.sampled_from([s, -s])),
    st.floats(-100.0, 100.0),
)
def test_an_analog_value_comes_back_within_half_a_unit_or_is_reported(
    kind: str, value: float, scale: float, offset: float
):
    field, lost = to_field(row('analog_output.1', scale=scale, offset=offset), value, kind, 0)
    low, high = INTEGERS[kind]
    assert low <= field <= high
    if not lost:
        back = from_field(row('analog_input.1', scale=1.0 / scale, offset=-offset / scale), field)
        # Half a unit of the whole number, and the rounding of numbers up to 1e8.
        assert abs(back - value) <= 0.5 / abs(scale) + 1e-6


EVENTS = st.lists(st.tuples(st.floats(0.001, 0.3), st.booleans()), max_size=30)


@given(EVENTS, st.floats(0.01, 0.2))
def test_a_debounced_input_changes_exactly_when_a_value_has_lasted(
    events: list[tuple[float, bool]], debounce: float
):
    value = InputValue(row('digital_input.1', debounce=debounce), 0.0)
    value.receive(0, 0.0)
    history, now = [(0.0, False)], 0.0
    for pause, on in events:
        now += pause
        value.receive(on, now)
        if on != history[-1][1]:
            history.append((now, on))
    # By the definition: the last level that lasted for the debounce time, up to the moment of asking.
    now += 0.5 * debounce
    ends = [time for time, _ in history[1:]] + [now]
    lasted = [
        on for (time, on), end in zip(history, ends, strict=True) if end >= time + debounce or time == 0.0
    ]
    assert value.update(now) == lasted[-1]


SCRIPT = parse_plc_script("""
initial: {digital_input.3: true}
rules:
  - {when: digital_output.1 rises, after: 0.8, set: {digital_input.1: true}}
  - {when: digital_output.1 falls, after: 0.3, set: {digital_input.1: false}}
  - {when: digital_input.1 rises, if: digital_input.3 is on, after: 0.25, set: {analog_input.1: 5}, for: 0.5}
  - {when: analog_output.1 above 2, set: {digital_input.2: true}}
  - {when: every 0.7 s, set: {digital_input.3: true}, for: 0.35}
""")
OUT = {name: parse_channel(name, {}) for name in ('digital_output.1', 'analog_output.1')}
STEPS = st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans(), st.floats(0.0, 4.0)), min_size=1, max_size=12)


def stepped(machine: ScriptedPlc, now: float, outputs: Mapping[Channel, float]) -> list[InputChange]:
    for channel, value in outputs.items():
        machine.output(channel.name, value)
    return machine.step(now)


@given(STEPS, st.lists(st.floats(0.0, 12.0), max_size=20))
def test_further_steps_between_change_nothing(steps: list[tuple[float, bool, float]], between: list[float]):
    once, often, now = ScriptedPlc(SCRIPT), ScriptedPlc(SCRIPT), 0.0
    seen_once, seen_often = [], []
    outputs: dict[Any, float] = {}
    for pause, digital, analog in steps:
        for time in sorted(between):
            if now <= time < now + pause:
                seen_often += stepped(often, time, outputs)
        now += pause
        outputs = {OUT['digital_output.1']: float(digital), OUT['analog_output.1']: analog}
        seen_once += stepped(once, now, outputs)
        seen_often += stepped(often, now, outputs)
    assert seen_often == seen_once
    assert often.inputs == once.inputs
    assert often.next_time == once.next_time > now


@given(STEPS)
def test_the_changes_lead_from_the_initial_to_the_final_inputs(steps: list[tuple[float, bool, float]]):
    plc, now = ScriptedPlc(SCRIPT), 0.0
    values, last = dict(plc.inputs), -math.inf
    for pause, digital, analog in steps:
        now += pause
        outputs = {OUT['digital_output.1']: float(digital), OUT['analog_output.1']: analog}
        for change in stepped(plc, now, outputs):
            assert last <= change.time <= now
            assert values[change.channel] != change.value
            values[change.channel], last = change.value, change.time
    assert values == plc.inputs


OUTPUT_NAMES = st.sampled_from(['digital', 'analog']).flatmap(
    lambda kind: st.tuples(
        st.integers(1, 8).map(lambda index: f'{kind}_output.{index}'),
        st.none() | (st.sampled_from([0.0, 1.0]) if kind == 'digital' else st.floats(-1e300, 1e300)),
    )
)


@given(st.lists(OUTPUT_NAMES).map(dict), st.lists(st.tuples(st.integers(1, 8), st.floats(-1e9, 1e9))))
def test_safe_outputs_are_as_declared_whatever_they_were(
    declared: dict[str, float | None], before: list[tuple[int, float]]
):
    assert parse_fail_safe(fail_safe_texts(declared)) == declared
    io = IoImage(digital=8, analog=8)
    for index, value in before:
        io.set_value(io.channel('analog', 'output', index), value)
        io.set_value(io.channel('digital', 'output', index), float(value > 0.0))
    outputs = [channel for channel in io.channels if channel.direction == 'output']
    values = {channel: io.value(channel) for channel in outputs}

    def make_safe() -> list[Channel]:
        return io.set_outputs(lambda output, value: safe_value(declared, output, value))

    changed = make_safe()
    for channel in outputs:
        expected = declared.get(channel.name, 0.0)
        assert io.value(channel) == (values[channel] if expected is None else expected)
        assert (channel in changed) == (io.value(channel) != values[channel])
    assert make_safe() == []


WORDS = st.sampled_from(
    [
        *('inputs:', 'outputs:', 'signals:', 'rules:', 'initial:', '  - ', '    ', '{', '}', 'when: start'),
        *('channel: digital_input.1', 'topic: a', 'type: Bool', 'field: "x["', 'bit: 70', 'set: {}', '\n'),
        *('timeout: 1', 'fail_safe: 0', 'bits: {0: x}', 'qos: 1', 'if: x is on', 'a: b', ', '),
        *(
            'modbus:',
            'modbus: {coil: 1}',
            'mqtt: {topic: a}',
            'opcua: {node: i=1}',
            '{host: b}',
            'endpoint: c',
        ),
        *('fail_safe:', 'digital_output.1: hold', 'analog_output.1: [1]', 'fail_safe: hold', 'x: .nan'),
    ]
)


@given(st.lists(WORDS, max_size=15))
def test_any_file_is_read_or_refused_with_a_line(words: list[str]):
    text = ''.join(words)
    for parse in (parse_io_map, parse_plc_script):
        try:
            parse(text, 'x.yaml')
        except InvalidInputError as error:
            refused = str(error)
        else:
            refused = 'x.yaml:1:'
        assert refused.startswith('x.yaml:')
