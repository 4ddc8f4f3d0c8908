"""Scripts of a PLC."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from read_texts import parse_plc_script
from robots_controller.io.plc_script import read_plc_script
from robots_core.errors import InvalidInputError

PROGRAMS = Path(__file__).parents[2] / 'programs'
RULE = 'rules:\n  - {%s}\n'
SET = 'set: {digital_input.3: 1}'


def test_the_rule_of_one_sentence():
    script = parse_plc_script(
        'rules:\n  - {when: digital_output.1 rises, after: 0.8, set: {digital_input.3: 1}}\n'
    )
    (rule,) = script.rules
    assert rule.event is not None
    assert (rule.event.channel.name, rule.after, rule.duration) == ('digital_output.1', 0.8, math.inf)
    assert [(channel.name, value) for channel, value in rule.settings] == [('digital_input.3', 1.0)]
    assert [channel.name for channel in script.channels] == ['digital_input.3', 'digital_output.1']
    assert [channel.name for channel in script.inputs] == ['digital_input.3']


def test_signals_name_channels():
    script = parse_plc_script(
        """
signals: {start: digital_output.2, ready: digital_input.1, force: analog_input.1}
initial: {ready: true}
rules:
  - when: start falls
    if: [ready is off, force above 2.5]
    set: {force: 7, ready: 1}
    for: 0.5
"""
    )
    (rule,) = script.rules
    assert [(c.channel.label, c.relation, c.bound) for c in rule.conditions] == [
        ('ready', 'is', 0.0),
        ('force', 'above', 2.5),
    ]
    assert {channel.label: value for channel, value in script.initial.items()} == {'ready': 1.0}
    assert rule.duration == 0.5


@pytest.mark.parametrize(
    ('text', 'line', 'message'),
    [
        ('{}', 1, 'the file has no content'),
        (RULE % SET, 2, 'when is missing'),
        (RULE % 'when: start', 2, 'set is missing'),
        (RULE % f'when: digital_output.1, {SET}', 2, "when is 'digital_output.1'; valid are 'output rises'"),
        (RULE % f'when: digital_output.1 jumps, {SET}', 2, "when is 'digital_output.1 jumps'"),
        (RULE % f'when: output.1 rises, {SET}', 2, "'output.1' is no channel"),
        (RULE % f'when: analog_output.1 rises, {SET}', 2, 'analog_output.1 is analog'),
        (RULE % f'when: digital_output.1 above 1, {SET}', 2, 'digital_output.1 is digital'),
        (RULE % f'when: analog_output.1 above x, {SET}', 2, "'x' is no finite number"),
        (RULE % f'when: analog_output.1 above nan, {SET}', 2, "'nan' is no finite number"),
        (RULE % f'when: every 0 s, {SET}', 2, 'every 0 s; valid is 0.001 to'),
        (RULE % f'when: every x s, {SET}', 2, "'x' is no finite number"),
        (RULE % f'when: start, after: -1, {SET}', 2, 'after is -1; valid is a number in [0, 86400]'),
        (RULE % f'when: start, for: 0, {SET}', 2, 'for is 0'),
        (RULE % f'when: start, wait: 1, {SET}', 2, "unknown key 'wait'"),
        (RULE % f'when: start, if: digital_input.1, {SET}', 2, "if is 'digital_input.1'; valid are"),
        (RULE % f'when: start, if: analog_input.1 is on, {SET}', 2, 'analog_input.1 is analog'),
        (RULE % 'when: start, set: {digital_output.1: 1}', 2, 'digital_output.1 is an output'),
        (RULE % 'when: start, set: {digital_input.1: 2}', 2, 'digital_input.1 is 2; valid are true'),
        (RULE % 'when: start, set: {analog_input.1: .inf}', 2, 'analog_input.1 is inf'),
        ('initial: {digital_output.1: 1}\n', 1, 'digital_output.1 is an output'),
        (
            'rules:\n  - when: start\n    if:\n      - digital_input.1 is on\n      - x is on\n    set: {}\n',
            5,
            "'x' is",
        ),
    ],
)
def test_a_mistake_is_reported_with_its_line(text: str, line: int, message: str):
    with pytest.raises(InvalidInputError) as info:
        parse_plc_script(text, 'plc.yaml')
    assert str(info.value).startswith(f'plc.yaml:{line}: {message}')


@pytest.mark.parametrize('path', sorted((PROGRAMS / 'io').glob('*.yaml')), ids=lambda path: path.name)
def test_the_scripts_of_the_programs_are_valid_and_belong_to_one(path: Path):
    script = read_plc_script(path)
    assert script.rules
    assert {channel.label for channel in script.channels} == set(script.signals)
