"""The scripted PLC, on a clock of the test's own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import pytest

from read_texts import parse_plc_script
from robots_controller.io.io_image import Channel
from robots_controller.io.plc_script import read_plc_script
from robots_controller.io.scripted_plc import InputChange, ScriptedPlc
from robots_core.errors import InvalidInputError

PRESS = Path(__file__).parents[2] / 'programs' / 'io' / 'press_tending.yaml'
OUTPUT = Channel('digital', 'output', 1)
LEVEL = Channel('analog', 'output', 1)


def plc(rules: str) -> ScriptedPlc:
    return ScriptedPlc(parse_plc_script(f'rules:\n{rules}'))


def stepped(machine: ScriptedPlc, now: float, outputs: Mapping[Channel, float]) -> list[InputChange]:
    for channel, value in outputs.items():
        machine.output(channel.name, value)
    return machine.step(now)


def changes(machine: ScriptedPlc, now: float, **outputs: float) -> list[tuple[float, str, float]]:
    named = {'output': OUTPUT, 'level': LEVEL}
    values = {named[name]: value for name, value in outputs.items()}
    return [(round(c.time, 9), c.channel.name, c.value) for c in stepped(machine, now, values)]


def test_when_an_output_rises_an_input_follows_after_its_time():
    machine = plc('  - {when: digital_output.1 rises, after: 0.8, set: {digital_input.3: 1}}')
    assert changes(machine, 1.0, output=0.0) == []
    assert machine.next_time == math.inf
    assert changes(machine, 2.0, output=1.0) == []
    assert machine.next_time == 2.8
    assert changes(machine, 2.7, output=1.0) == []
    assert changes(machine, 3.0) == [(2.8, 'digital_input.3', 1.0)]
    assert changes(machine, 4.0, output=0.0) == []
    assert machine.next_time == math.inf


def test_what_is_due_is_reported_with_its_rule():
    machine = plc("""
  - {when: every 5 s, after: 0.5, set: {digital_input.4: 1}}
  - {when: digital_output.1 rises, after: 0.8, set: {digital_input.3: 1}, for: 1.0}
""")
    every, due = (5.5, 3, {'digital_input.4': 1.0}), (2.8, 4, {'digital_input.3': 1.0})
    assert pending(machine) == [every]
    changes(machine, 2.0, output=1.0)
    assert pending(machine) == [due, every]
    changes(machine, 3.0)
    back = (3.8, 4, {'digital_input.3': 0.0})
    assert pending(machine) == [back, every]


def pending(machine: ScriptedPlc) -> list[tuple[float, int, Mapping[str, float]]]:
    return [(round(time, 9), line, inputs) for time, line, inputs in machine.pending]


def test_rules_of_inputs_follow_each_other_without_losing_time():
    machine = plc("""
  - {when: digital_output.1 rises, after: 0.5, set: {digital_input.1: 1}}
  - {when: digital_input.1 rises, after: 0.25, set: {analog_input.2: 3.5}}
""")
    stepped(machine, 0.0, {OUTPUT: 1.0})
    assert changes(machine, 10.0) == [(0.5, 'digital_input.1', 1.0), (0.75, 'analog_input.2', 3.5)]


def test_a_pulse_gives_back_what_was_there():
    machine = plc(
        '  - {when: digital_output.1 changes, set: {digital_input.1: 1, analog_input.1: 2}, for: 0.25}'
    )
    assert changes(machine, 1.0, output=1.0) == [(1.0, 'digital_input.1', 1.0), (1.0, 'analog_input.1', 2.0)]
    assert changes(machine, 2.0, output=0.0) == [
        (1.25, 'digital_input.1', 0.0),
        (1.25, 'analog_input.1', 0.0),
        (2.0, 'digital_input.1', 1.0),
        (2.0, 'analog_input.1', 2.0),
    ]


def test_conditions_are_those_of_the_trigger():
    machine = plc("""
  - {when: start, after: 1, set: {digital_input.2: 1}}
  - {when: digital_output.1 rises, if: digital_input.2 is off, after: 2, set: {digital_input.1: 1}}
""")
    stepped(machine, 0.5, {OUTPUT: 1.0})
    assert changes(machine, 3.0, output=0.0) == [(1.0, 'digital_input.2', 1.0), (2.5, 'digital_input.1', 1.0)]
    stepped(machine, 4.0, {OUTPUT: 1.0})
    assert machine.next_time == math.inf


def test_an_analog_output_triggers_where_it_passes_the_bound():
    machine = plc("""
  - {when: analog_output.1 above 2, set: {digital_input.1: 1}}
  - {when: analog_output.1 below 1, set: {digital_input.1: 0}}
""")
    seen = [changes(machine, now, level=level) for now, level in enumerate((2.0, 2.1, 5.0, 1.0, 0.9, 0.0))]
    assert [len(found) for found in seen] == [0, 1, 0, 0, 1, 0]


def test_a_period_repeats():
    machine = plc('  - {when: every 0.5 s, set: {digital_input.1: 1}, for: 0.125}')
    times = [time for time, _, value in changes(machine, 2.1) if value]
    assert times == [0.5, 1.0, 1.5, 2.0]


def test_a_time_before_the_last_step_is_refused():
    machine = plc('  - {when: start, set: {digital_input.1: 1}}')
    machine.step(1.0)
    for now in (0.9, math.nan):
        with pytest.raises(InvalidInputError, match='is before the last step'):
            machine.step(now)


def test_rules_that_trigger_each_other_without_end_are_refused():
    machine = plc("""
  - {when: digital_input.1 rises, set: {digital_input.1: 0}}
  - {when: digital_input.1 falls, set: {digital_input.1: 1}}
  - {when: start, set: {digital_input.1: 1}}
""")
    with pytest.raises(InvalidInputError, match='trigger each other without end at 0 s'):
        machine.step(0.0)


def test_a_cycle_acts_on_every_change_of_an_output_in_order():
    machine = ScriptedPlc(
        parse_plc_script("""rules:
  - {when: digital_output.1 rises, set: {digital_input.1: 1}}
  - {when: digital_output.1 falls, set: {analog_input.1: 2.5}}
  - {when: start, after: 2, set: {digital_input.2: 1}}
"""),
        0.0,
    )
    assert machine.next_time == 0.0
    assert machine.step(0.0) == []
    assert machine.next_time == 2.0
    for name, value in (('digital_output.7', 1.0), ('digital_output.1', 0.0)):
        machine.output(name, value)
    assert machine.next_time == 2.0  # nothing that matters has changed
    for value in (1.0, 1.0, 0.0):
        machine.output('digital_output.1', value)
    assert machine.next_time == 0.0
    assert [(c.time, c.channel.name, c.value) for c in machine.step(3.0)] == [
        (2.0, 'digital_input.2', 1.0),
        (3.0, 'digital_input.1', 1.0),
        (3.0, 'analog_input.1', 2.5),
    ]
    assert machine.step(4.0) == []


def test_the_press_makes_a_stroke_for_each_part():
    script = read_plc_script(PRESS)
    machine = ScriptedPlc(script)
    signal = script.signals
    outputs = {signal[name]: 0.0 for name in ('start_press', 'gripper', 'part_placed')}
    now = 0.0

    def step(until: float, **switched: float) -> dict[str, float]:
        nonlocal now
        outputs.update({signal[name]: value for name, value in switched.items()})
        stepped(machine, now, outputs)
        now = until
        stepped(machine, now, outputs)
        return {channel.label: value for channel, value in machine.inputs.items()}

    for part in range(3):
        seen = step(now + 1.0)
        assert (seen['part_present'], seen['press_ready'], seen['part_pressed']) == (1, 1, 0), part
        assert step(now + 1.0, gripper=1)['part_present'] == 0
        step(now + 1.0, gripper=0)
        seen = step(now + 0.9, start_press=1)
        assert (seen['press_closed'], seen['press_ready'], seen['press_force']) == (1, 0, 250)
        seen = step(now + 2.0, start_press=0)
        assert (seen['press_closed'], seen['press_ready'], seen['press_force']) == (0, 1, 0)
        assert seen['part_pressed'] == 1
        assert step(now + 1.0, gripper=1)['part_pressed'] == 0
        step(now + 0.1, gripper=0, part_placed=1)
        step(now + 1.0, part_placed=0)
