"""Maps of channels to topics."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from read_texts import parse_io_map
from robots_controller.io.bridge.topic_field import TopicField
from robots_controller.io.io_map import IoRow, read_io_map
from robots_core.cell_interface.topic_qos import Profile
from robots_core.errors import InvalidInputError

CONFIG = Path(__file__).parents[2] / 'robots_controller' / 'config'

ROW = '  - {channel: %s, topic: plc/a, type: UInt16MultiArray, field: "data[0]"%s}\n'


def fields(row: IoRow) -> TopicField:
    assert isinstance(row.place, TopicField)
    return row.place


def inputs(*rows: tuple[str, str]) -> str:
    return 'inputs:\n' + ''.join(ROW % row for row in rows)


def outputs(*rows: tuple[str, str]) -> str:
    return 'outputs:\n' + ''.join(ROW % row for row in rows)


def test_the_example_of_words():
    io_map = read_io_map(CONFIG / 'io_map_words.yaml')
    bits = {row.channel.name: row.bit for row in io_map.inputs if row.channel.kind == 'digital'}
    assert bits == {f'digital_input.{n}': bit for n, bit in ((1, 0), (2, 1), (3, 2), (4, 3), (5, 8))}
    contact = next(row for row in io_map.inputs if row.channel.index == 5)
    assert (contact.invert, contact.debounce, contact.timeout, contact.fail_safe) == (True, 0.02, 0.5, 0.0)
    assert {fields(row).type for row in io_map.inputs} == {'std_msgs/msg/UInt16MultiArray'}
    assert [row.place.text for row in io_map.outputs] == ['data[0]'] * 3 + ['data[1]']
    assert [row.period for row in io_map.outputs] == [0.1] * 3 + [math.inf]


def test_the_example_of_tags():
    io_map = read_io_map(CONFIG / 'io_map_tags.yaml')
    assert io_map.signals['press_ready'].name == 'digital_input.1'
    assert [row.channel.label for row in io_map.inputs] == [
        *('press_ready', 'press_closed', 'part_present', 'press_force')
    ]
    assert io_map.inputs[1].fail_safe == 1.0
    assert fields(io_map.inputs[3]).qos == Profile('', '', depth=10, reliable=False)
    assert fields(io_map.outputs[0]).qos == Profile('', '', depth=1, latched=True)


def test_the_example_of_a_plant_which_a_lock_step_run_refuses():
    io_map = read_io_map(CONFIG / 'io_map_plant.yaml')
    assert set(io_map.servers) == {'modbus plc', 'opcua press', 'mqtt plant'}
    assert [row.period for row in io_map.inputs[:2]] == [0.05, 0.05]
    with pytest.raises(
        InvalidInputError, match=r'plant.yaml:17: modbus plc is not connected in lock-step; topics'
    ):
        io_map.check_simulated_time()


def test_types_are_written_short_or_in_full():
    text = 'inputs:\n  - {channel: analog_input.1, topic: /a, type: %s, field: x}\n'
    for written, full in (
        ('Float32', 'std_msgs/msg/Float32'),
        ('geometry_msgs/Point', 'geometry_msgs/msg/Point'),
        ('geometry_msgs/msg/Point', 'geometry_msgs/msg/Point'),
    ):
        assert fields(parse_io_map(text % written).inputs[0]).type == full


@pytest.mark.parametrize(
    ('text', 'line', 'message'),
    [
        ('signals: {}\n', 1, 'the file maps nothing'),
        ('input: []\n', 1, "unknown key 'input'; did you mean 'inputs'?"),
        (inputs(('digital_input.0', '')), 2, "'digital_input.0' is no channel"),
        (inputs(('digital_input.99999', '')), 2, "'digital_input.99999' is no channel"),
        (inputs(('digital_output.1', '')), 2, 'digital_output.1 stands below inputs'),
        (outputs(('analog_input.1', '')), 2, 'analog_input.1 stands below outputs'),
        (inputs(('digital_input.1', ', bit: 64')), 2, 'bit is 64; valid is a whole number in 0..63'),
        (inputs(('analog_input.1', ', bit: 1')), 2, 'analog_input.1 cannot be one bit'),
        (inputs(('digital_input.1', ', scale: 2')), 2, 'scale is not for digital channels'),
        (inputs(('analog_input.1', ', invert: true')), 2, 'invert is not for analog channels'),
        (inputs(('analog_input.1', ', scale: 0')), 2, 'scale is 0'),
        (inputs(('analog_input.1', ', scale: .nan')), 2, 'scale is nan; valid is a finite number'),
        (inputs(('digital_input.1', ', debounce: -1')), 2, 'debounce is -1'),
        (outputs(('digital_output.1', ', debounce: 1')), 2, 'debounce is not for outputs'),
        (inputs(('digital_input.1', ', period: 1')), 2, 'period is not for inputs'),
        (inputs(('digital_input.1', ', timeout: 1')), 2, 'timeout and fail_safe need each other'),
        (inputs(('digital_input.1', ', timeout: 0, fail_safe: 0')), 2, 'timeout is 0'),
        (
            outputs(('digital_output.1', ', timeout: 0.1, fail_safe: 0')),
            2,
            'timeout is 0.1; valid is a number in [0.2, ',
        ),
        (inputs(('digital_input.1', ', timeout: 1, fail_safe: 2')), 2, 'fail_safe is 2; valid are true and'),
        (
            inputs(('digital_input.1', ', bit: 0'), ('digital_input.1', ', bit: 1')),
            3,
            'digital_input.1 is mapped in line 2',
        ),
        (inputs(('digital_input.1', ', qos: {depth: 0}')), 2, 'depth is 0'),
        (
            inputs(('digital_input.1', ', qos: {reliability: some}')),
            2,
            "reliability is 'some'; valid are reliable, best_effort",
        ),
        (inputs(('digital_input.1', ', qos: {deep: 1}')), 2, "unknown key 'deep'"),
        (inputs(('digital_input.1', ', debunce: 1')), 2, "unknown key 'debunce'; did you mean 'debounce'?"),
        (
            inputs(('digital_input.1', ''), ('digital_input.2', ', qos: {depth: 2}')),
            3,
            'plc/a has another qos here than in line 2',
        ),
        (
            outputs(('digital_output.1', ', bit: 0'), ('digital_output.2', ', bit: 0')),
            3,
            'bit 0 of data[0] of plc/a is set in line 2 already',
        ),
        (
            outputs(('digital_output.1', ', bit: 0'), ('analog_output.2', '')),
            3,
            'data[0] of plc/a is set in line 2 already',
        ),
        (
            inputs(('digital_input.1', '')) + outputs(('digital_output.1', '')),
            4,
            'plc/a is an input in line 2',
        ),
        ('inputs:\n  - {channel: digital_input.1, topic: a b, type: Bool}\n', 2, "'a b' is no topic"),
        ('inputs:\n  - {channel: digital_input.1, topic: a, type: Bol}\n', 2, "'Bol' is no message type"),
        (
            'inputs:\n  - {channel: digital_input.1, topic: a, type: Bool, field: "data["}\n',
            2,
            "'data[' is no path",
        ),
        ('inputs:\n  - {channel: digital_input.1, type: Bool}\n', 2, 'topic is missing'),
        (
            'inputs:\n  - channel: digital_input.1\n    bits: {0: digital_input.2}\n',
            2,
            'channel and bits exclude each other',
        ),
        (
            'inputs:\n  - topic: a\n    bits:\n      0: digital_input.2\n      x: digital_input.1\n',
            5,
            "bit 'x' is no whole number",
        ),
        (
            'inputs:\n  - topic: a\n    bits:\n      0: digital_input.2\n      1: nothing\n',
            5,
            "'nothing' is no channel",
        ),
        (
            'signals:\n  a: digital_input.1\n  b: digital_input.1\n',
            3,
            "digital_input.1 has the name 'a' already",
        ),
        ('signals:\n  "a.b": digital_input.1\n', 2, "'a.b' cannot name"),
        ('signals:\n  a: digital_inputs.1\n', 2, "'digital_inputs.1' is no channel"),
    ],
)
def test_a_mistake_is_reported_with_its_line(text: str, line: int, message: str):
    with pytest.raises(InvalidInputError) as info:
        parse_io_map(text, 'map.yaml')
    assert str(info.value).startswith(f'map.yaml:{line}: {message}')


def test_a_topic_has_one_type():
    text = (
        'inputs:\n  - {channel: digital_input.1, topic: a, type: Bool}\n'
        '  - {channel: digital_input.2, topic: a, type: Int8}\n'
    )
    with pytest.raises(
        InvalidInputError,
        match=r'map\.yaml:3: a is a std_msgs/msg/Int8 here and a std_msgs/msg/Bool in line 2',
    ):
        parse_io_map(text, 'map.yaml')
