"""Emergency stop by a digital input: how files declare it, and a simulated cell that it stops."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.io.cell_io import read_cell_io
from robots_controller.io.io_image import Channel
from robots_controller.io.stopping_inputs import (
    emergency_reason,
    emergency_stop_texts,
    parse_emergency_stop,
    unknown_inputs,
    unknown_label,
)
from robots_core.errors import InvalidInputError, RobotsError

from .simulated_program import run_text

PLC = """
signals: {e_stop: digital_input.2}
emergency_stop: {e_stop: off}
initial: {e_stop: 1}
"""
MOVE = (
    'while true do ptpJointSpaceAngles(20, -80, 80, 0, 60, 0) ptpJointSpaceAngles(-20, -80, 80, 0, 60, 0) end'
)


def written(folder: Path, text: str, name: str = 'plc.yaml') -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_the_inputs_of_a_file_stop_at_their_values(tmp_path: Path) -> None:
    io = read_cell_io(written(tmp_path, PLC + 'rules: []'))
    assert dict(io.emergency_stop) == {'digital_input.2': 0}
    inputs = parse_emergency_stop([*emergency_stop_texts(io.emergency_stop), 'digital_input.3=on', ''])
    assert emergency_reason(inputs, [0, 1, 0]) == ''
    assert emergency_reason(inputs, [1, 0, 0]) == 'emergency stop by digital_input.2'
    assert emergency_reason(inputs, [1, 0, 1]) == 'emergency stop by digital_input.2, digital_input.3'


def test_an_input_that_the_image_does_not_have_stops_as_its_value_is_unknown() -> None:
    inputs = parse_emergency_stop(['digital_input.2=off', 'digital_input.3=on'])
    assert (
        emergency_reason(inputs, [0, 1])
        == 'emergency stop by digital_input.3 (unknown: digital_inputs is too short)'
    )
    assert emergency_reason(inputs, []).count('digital_inputs is too short') == 2


def test_an_input_without_a_value_of_the_plc_stops_with_why() -> None:
    inputs = parse_emergency_stop(['digital_input.2=off', 'digital_input.3=off'])
    why = {
        Channel('digital', 'input', 2): 'Modbus plc:502 has sent no value yet',
        Channel('analog', 'input', 3): 'plc/level has sent no value yet',
    }
    unknown = unknown_inputs([unknown_label(why), 'digital_input.1..3', ''])
    assert unknown == {2: 'Modbus plc:502 has sent no value yet'}
    assert emergency_reason(inputs, [0, 0, 1], unknown) == (
        'emergency stop by digital_input.2 (unknown: Modbus plc:502 has sent no value yet)'
    )
    assert emergency_reason(inputs, [0, 0, 0], unknown).endswith('sent no value yet), digital_input.3')
    assert emergency_reason(inputs, [0, 1, 1], unknown) == ''


def test_an_input_that_nothing_sets_is_refused_with_those_that_are_set(tmp_path: Path) -> None:
    script = written(tmp_path, PLC.replace('initial: {e_stop: 1}', 'initial: {digital_input.7: 1}'))
    with pytest.raises(
        RobotsError, match=r'digital_input\.2 is set by nothing in .*plc\.yaml.*digital_input\.7$'
    ):
        read_cell_io(script)
    outputs = written(
        tmp_path, 'outputs:\n  - {channel: digital_output.1, topic: a, type: Bool}\n', 'map.yaml'
    )
    alone = written(tmp_path, 'emergency_stop: {digital_input.1: off}', 'alone.yaml')
    with pytest.raises(RobotsError, match=r'input\.1 is set by nothing .* valid are none of the digital'):
        read_cell_io(alone, outputs)
    rows = 'inputs:\n  - {channel: digital_input.1, topic: a, type: Bool}\n'
    inputs = written(tmp_path, rows, 'map.yaml')
    assert dict(read_cell_io(alone, inputs).emergency_stop) == {'digital_input.1': 0}


def test_an_input_beyond_those_of_a_cell_is_refused(tmp_path: Path) -> None:
    text = 'initial: {digital_input.33: 1}\nemergency_stop: {digital_input.33: off}'
    with pytest.raises(RobotsError, match=r'input\.33 is no input of a cell, .* digital_input\.1 to 32'):
        read_cell_io(written(tmp_path, text))


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('emergency_stop: {digital_output.1: off}', r'plc\.yaml:1: digital_output\.1 is no digital input'),
        ('emergency_stop: {analog_input.1: off}', r'plc\.yaml:1: analog_input\.1 is no digital input'),
        ('emergency_stop: {digital_input.1: 5}', r'plc\.yaml:1: digital_input\.1 is 5; valid are'),
        ('emergency_stop: {button: off}', r"plc\.yaml:1: 'button' is no channel"),
    ],
)
def test_what_cannot_stop_is_refused_with_its_line(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        read_cell_io(written(tmp_path, text))


@pytest.mark.parametrize('text', ['digital_input.1', 'digital_input.1=low', 'digital_output.1=on', 'x=on'])
def test_parameters_that_name_no_input_and_value_are_refused(text: str) -> None:
    with pytest.raises(InvalidInputError, match='is no'):
        parse_emergency_stop([text])


def test_two_files_that_say_different_things_are_refused(tmp_path: Path) -> None:
    script = written(tmp_path, 'initial: {digital_input.1: 1}\nemergency_stop: {digital_input.1: off}')
    rows = 'outputs:\n  - {channel: digital_output.1, topic: a, type: Bool}\n'
    same = written(tmp_path, rows + 'emergency_stop: {digital_input.1: off}', 'same.yaml')
    assert dict(read_cell_io(script, same).emergency_stop) == {'digital_input.1': 0}
    other = written(tmp_path, rows + 'emergency_stop: {digital_input.1: on}', 'other.yaml')
    with pytest.raises(RobotsError, match=r'emergency_stop: digital_input\.1 is 0 in .* and 1 in'):
        read_cell_io(script, other)


def test_an_input_ends_the_program_and_stops_the_robot(tmp_path: Path) -> None:
    rules = 'rules:\n  - {when: start, after: 0.5, set: {e_stop: 0}}\n'
    run = run_text(tmp_path, MOVE, io=written(tmp_path, PLC + rules))
    assert run.state == 'FAILED'
    assert str(run.error) == 'program.lua:1: emergency stop by digital_input.2'
    assert 0.5 < run.duration < 1.5
    assert not run.velocity[-1].any()


def test_a_simulation_without_a_plc_says_what_sends_nothing(tmp_path: Path) -> None:
    rows = 'inputs:\n  - {channel: digital_input.2, topic: plc/e_stop, type: Bool}\n'
    io_map = written(tmp_path, rows + 'emergency_stop: {digital_input.2: off}', 'map.yaml')
    run = run_text(tmp_path, MOVE, io_map=io_map)
    assert run.state == 'FAILED'
    assert 'digital_input.2 (unknown: nothing sends plc/e_stop in a simulation)' in str(run.error)
    assert not run.velocity.any()


def test_a_circuit_that_is_open_from_the_start_lets_nothing_move(tmp_path: Path) -> None:
    run = run_text(tmp_path, MOVE, io=written(tmp_path, PLC.replace('e_stop: 1', 'e_stop: 0')))
    assert run.state == 'FAILED'
    assert 'emergency stop by digital_input.2' in str(run.error)
    assert not run.velocity.any()
