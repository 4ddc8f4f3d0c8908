"""Fail-safe values of outputs: how they are declared, and when a cell sets them."""

from __future__ import annotations

from pathlib import Path

import pytest

from cell_options import nodes_of_cell
from read_texts import parse_io_map, parse_plc_script
from robots_controller.control.stops.faults import Fault
from robots_controller.io.cell_io import read_cell_io
from robots_controller.io.fail_safe import fail_safe_texts, parse_fail_safe
from robots_controller.io.io_map import OUTPUT_TIMEOUT
from robots_controller.simulation.record.events import OutputChanged, ProgramStateChanged
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model
from robots_core.errors import InvalidInputError, RobotsError

from .simulated_program import PERIOD, ROBOT, run_text
from .test_simulated_stops import stopped

DECLARED = """
signals: {gun: digital_output.1, gripper: digital_output.2, coolant: digital_output.3}
fail_safe: {gripper: hold, coolant: on, analog_output.1: 0.5}
"""
ON = 'setDigitalOutput("gun", true) setDigitalOutput("gripper", true) setAnalogOutput(1, 3)\n'
SAFE = [('analog', 1, 0.5), ('digital', 2, 1.0), ('digital', 3, 1.0)]
"""Outputs that are not 0 afterwards."""


def run_program(tmp_path: Path, text: str) -> SimulationRun:
    (tmp_path / 'outputs.yaml').write_text(DECLARED)
    return run_text(tmp_path, text, io=tmp_path / 'outputs.yaml')


def left(run: SimulationRun) -> list[tuple[str, int, float]]:
    """The outputs that are not 0 at the end."""
    values = {(e.kind, e.index): e.value for e in run.events if isinstance(e, OutputChanged)}
    return [(*output, value) for output, value in sorted(values.items()) if value != 0.0]


# -- declared ------------------------------------------------------------------------------------------


def test_files_declare_them_by_name_or_channel():
    declared = {'digital_output.2': None, 'digital_output.3': 1.0, 'analog_output.1': 0.5}
    script = parse_plc_script(DECLARED)
    assert script.fail_safe == declared
    assert not script.inputs
    texts = fail_safe_texts(script.fail_safe)
    assert texts == ['digital_output.2=hold', 'digital_output.3=1.0', 'analog_output.1=0.5']
    assert parse_fail_safe(['', *texts]) == declared


def test_rows_of_a_map_declare_those_of_their_outputs():
    io_map = parse_io_map(
        'fail_safe: {digital_output.9: hold}\n'
        'outputs:\n'
        '  - {bits: {0: digital_output.1, 1: digital_output.2}, topic: a, type: UInt8, fail_safe: hold}\n'
        '  - {channel: analog_output.1, topic: b, type: Float64, fail_safe: 2.5, timeout: 1}\n'
        '  - {channel: digital_output.2, topic: c, type: Bool}\n'
    )
    assert io_map.fail_safe == {
        'digital_output.9': None,
        'digital_output.1': None,
        'digital_output.2': None,
        'analog_output.1': 2.5,
    }
    assert [row.timeout for row in io_map.outputs] == [OUTPUT_TIMEOUT, OUTPUT_TIMEOUT, 1.0, OUTPUT_TIMEOUT]


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('digital_input.1: 0', 'digital_input.1 is an input'),
        ('digital_output.1: 2', 'digital_output.1 is 2; valid are true and false'),
        ('analog_output.1: .inf', 'analog_output.1 is inf; valid is a finite number'),
        ('gun: hold', "'gun' is no channel"),
    ],
)
def test_a_mistake_has_its_line(text: str, message: str):
    for parse in (parse_plc_script, parse_io_map):
        with pytest.raises(InvalidInputError, match=r'\.yaml:2: ') as info:
            parse(f'fail_safe:\n  {text}\n')
        assert message in str(info.value)


def test_an_output_has_one_fail_safe_value(tmp_path: Path):
    rows = 'outputs:\n  - {channel: digital_output.1, topic: a, type: Bool, fail_safe: hold}\n'
    again = '  - {channel: digital_output.1, topic: b, type: Bool, fail_safe: false}\n'
    with pytest.raises(InvalidInputError, match=r'yaml:3: digital_output\.1 has another fail-safe value'):
        parse_io_map(rows + again)
    script, io_map = tmp_path / 'plc.yaml', tmp_path / 'map.yaml'
    io_map.write_text(rows)
    script.write_text('fail_safe: {digital_output.2: hold}\n')
    assert read_cell_io(script, io_map).fail_safe == {'digital_output.1': None, 'digital_output.2': None}
    nodes = {
        node.executable: node for node in nodes_of_cell(robot='bello_bot', io=str(script), io_map=str(io_map))
    }
    for name in ('lua_program_node', 'io_bridge_node'):
        assert nodes[name].parameters['fail_safe'] == ['digital_output.2=hold', 'digital_output.1=hold']
    script.write_text('fail_safe: {digital_output.1: on}\n')
    with pytest.raises(RobotsError, match=r'fail_safe: digital_output\.1 is 1 in .* and hold in'):
        read_cell_io(script, io_map)


@pytest.mark.parametrize('text', ['digital_output.1', 'digital_output.1=2', 'gun=hold', 'digital_input.1=0'])
def test_a_parameter_that_is_not_valid_is_refused(text: str):
    with pytest.raises(InvalidInputError):
        parse_fail_safe([text])


def test_an_output_that_there_is_not_is_refused(tmp_path: Path):
    (tmp_path / 'outputs.yaml').write_text('fail_safe: {digital_output.99: hold}')
    with pytest.raises(InvalidInputError, match=r"no channel is named 'digital_output\.99'"):
        run_text(tmp_path, 'wait(1)', io=tmp_path / 'outputs.yaml')


# -- set -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    'end',
    [
        'error("no part")',
        'ptpJointSpaceAngles(0, 500, 0, 0, 0, 0)',
        'waitDigitalInput(1, true)',  # for ever: the cell stops it
        'pulseDigitalOutput("gun", 60) wait(1) setAnalogOutput(99, 1)',
    ],
)
def test_a_program_that_fails_leaves_fail_safe_outputs(tmp_path: Path, end: str):
    run = run_program(tmp_path, ON + end)
    assert run.state == 'FAILED'
    assert left(run) == SAFE


def test_a_program_that_finishes_keeps_its_outputs(tmp_path: Path):
    run = run_program(tmp_path, ON)
    assert run.ok
    assert left(run) == [('analog', 1, 3.0), ('digital', 1, 1.0), ('digital', 2, 1.0)]


MOVE = 'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
RAW_SEAM = """linearRelative(0, 0, -0.4, 0, 0, 0, {blend = 0.05, on_path = {
  {distance_after_start = 0.02, output = 1, value = true},
  {distance_before_end = 0.05, output = 2, value = true}}})
"""
SEAM = RAW_SEAM.replace('= 1,', '= "gun",').replace('= 2,', '= "gripper",')


def switched(run: SimulationRun) -> list[tuple[int, float, float]]:
    """Gun and gripper: index, value and time."""
    events = [event for event in run.events if isinstance(event, OutputChanged)]
    return [(e.index, e.value, e.time) for e in events if e.kind == 'digital' and e.index < 3]


def test_a_robot_that_brakes_for_a_failure_switches_nothing_more(tmp_path: Path):
    (tmp_path / 'watch.lua').write_text('wait(0.6) error("lost")')
    place = '{distance_after_start = %g, output = "gun", value = %s}'
    places = ', '.join(place % (0.01 * n, ('false', 'true')[n % 2]) for n in range(1, 39))
    seam = f'linearRelative(0, 0, -0.4, 0, 0, 0, {{on_path = {{{places}}}}})'
    run = run_program(tmp_path, f'{MOVE}startTask("watch")\n{seam}')
    assert 'lost' in str(run.error)
    failed = next(e.time for e in run.events if isinstance(e, ProgramStateChanged) and e.state == 'FAILED')
    assert len(switched(run)) > 3
    assert all(time <= failed for _, _, time in switched(run))
    assert left(run) == [('analog', 1, 0.5), ('digital', 3, 1.0)]
    z = [load_robot_model(ROBOT).direct_kinematics(q)[0][2] for q in run.position[run.time >= failed]]
    assert z[0] - z[-1] > 0.02  # the braking robot has passed places


def test_motions_before_one_that_is_refused_have_their_outputs_and_then_they_are_safe(tmp_path: Path):
    run = run_program(tmp_path, MOVE + SEAM + 'linearRelative(0, 0, 9, 0, 0, 0)')
    assert run.state == 'FAILED'
    assert [one[:2] for one in switched(run)] == [(1, 1.0), (2, 1.0), (1, 0.0)]
    assert switched(run)[-1][2] == pytest.approx(run.motions[1].ended, abs=PERIOD)


def test_a_fault_takes_their_outputs_from_motions_that_a_failed_program_has_left(tmp_path: Path):
    run = stopped(tmp_path, f'{MOVE}{RAW_SEAM}linearRelative(0, 0, 9, 0, 0, 0)', Fault.EMERGENCY_STOP, at=2.4)
    reasons = [motion.message for motion in run.motions]
    assert reasons[1] == 'emergency stop!'
    on, off = switched(run)
    assert (on[:2], off[:2]) == ((1, 1.0), (1, 0.0))
    assert on[2] < 2.4 <= off[2] < 2.5 < run.motions[1].ended
