"""Programs in a simulated cell: time, samples, inputs and outputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.recording.bag_file import read_bag
from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import (
    CommandStateChanged,
    InputChanged,
    LineReached,
    OutputChanged,
)
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.errors import RobotsError

from .simulated_program import PERIOD, PROGRAMS, ROBOT, outputs, run_text


@pytest.fixture(scope='module')
def welding() -> SimulationRun:
    return simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='ideal')


def test_the_welding_program_is_the_paper_s(welding: SimulationRun):
    states = [event.state for event in welding.events if isinstance(event, CommandStateChanged)]
    assert states == ['IDLE', 'PTPJOINT_JOINT', 'IDLE'] + 3 * ['PTPCARTESIAN', 'IDLE']
    assert welding.state == 'FINISHED'
    assert welding.printed == ('Welding Program 1',)
    assert [motion.command.line for motion in welding.motions] == [6, 7, 8, 12]
    assert all(motion.ok and motion.message == 'reached' for motion in welding.motions)
    # The gun is on for exactly the second that the program waits, between the third and the fourth motion.
    (on, first), (off, second) = outputs(welding)
    assert (first, second) == (1.0, 0.0)
    assert off - on == pytest.approx(1.0, abs=1e-9)  # waits end at the nanosecond
    assert welding.motions[2].ended <= on < off <= welding.motions[3].started


def test_every_period_is_recorded(welding: SimulationRun):
    assert welding.time[0] == 0.0
    assert np.diff(welding.time) == pytest.approx(PERIOD, abs=1e-9)
    assert welding.duration == pytest.approx(welding.time[-1], abs=PERIOD)
    k, n = welding.time.size, len(welding.axes)
    assert welding.reference.shape == (k, 3, n)
    assert welding.position.shape == welding.velocity.shape == (k, n)
    assert welding.torque is None
    for array in (welding.time, welding.reference, welding.position):
        assert not array.flags.writeable


def test_times_that_are_passed_at_once_are_as_those_passed_one_by_one(tmp_path: Path):
    # Second-order drives creep for longer than the wait takes, so that nothing is passed at once with them.
    still = run_text(tmp_path, 'wait(0.5)')
    crept = run_text(tmp_path, 'wait(0.5)', drive='second_order')
    assert still.time.tolist() == crept.time.tolist()
    assert (still.position == still.position[0]).all()
    assert still.reference.tolist() == crept.reference.tolist()


@pytest.mark.parametrize('times', [(0.0,), (1.0,), (0.0013,), (0.1, 0.2, 0.3), (0.004, 0.004), (1e-12, 7.7)])
def test_waits_take_simulated_time(tmp_path: Path, times: tuple[float, ...]):
    lines = [f'wait({time!r}) setDigitalOutput({i}, 1)' for i, time in enumerate(times, 1)]
    run = run_text(tmp_path, '\n'.join(lines))
    assert run.ok
    # Rounded up to nanoseconds, each.
    ends = [time for time, _ in outputs(run)]
    assert ends == pytest.approx(np.cumsum(times).tolist(), abs=2e-9 * len(times))


def test_computing_takes_no_time(tmp_path: Path):
    run = run_text(tmp_path, 'local x = 0 for i = 1, 300000 do x = x + i end setDigitalOutput(1, 1)')
    assert outputs(run) == [(0.0, 1.0)]


def test_a_loop_that_reads_an_input_lets_time_pass(tmp_path: Path):
    (tmp_path / 'plc.yaml').write_text('rules: [{when: start, after: 0.2, set: {digital_input.1: 1}}]')
    text = 'while not getDigitalInput(1) do end setDigitalOutput(1, 1)'
    run = run_text(tmp_path, text, io=tmp_path / 'plc.yaml')
    assert run.ok
    assert 0.2 <= outputs(run)[0][0] <= 0.2 + 2 * PERIOD


def test_lines_are_those_of_the_program(welding: SimulationRun):
    assert [e.line for e in welding.events if isinstance(e, LineReached)] == [3, 4, 5, 6, 7, 8, 9, 10, 11, 12]


def test_a_plc_and_the_program_work_together():
    io = PROGRAMS / 'io' / 'press_tending.yaml'
    run = simulate(PROGRAMS / 'press_tending.lua', robot=ROBOT, drive='ideal', io=io)
    assert run.ok
    assert run.printed == ('part 1: 250 kN', 'part 2: 250 kN', '2 parts pressed')
    force = [e for e in run.events if isinstance(e, InputChanged) and (e.kind, e.index) == ('analog', 1)]
    assert [event.value for event in force] == [250.0, 0.0, 250.0, 0.0]
    starts = [e.time for e in run.events if isinstance(e, OutputChanged) and (e.index, e.value) == (1, 1.0)]
    # The press closes 0.8 s after its start; the PLC looks once in a period.
    assert [event.time for event in force[::2]] == pytest.approx([t + 0.8 for t in starts], abs=2 * PERIOD)


def test_a_handler_brakes_the_robot_and_lets_it_go_on(tmp_path: Path):
    (tmp_path / 'plc.yaml').write_text('rules: [{when: start, after: 0.5, set: {digital_input.2: 1}}]')
    text = """
    onDigitalInput(2, true, function() setDigitalOutput(1, 1) wait(1) setDigitalOutput(1, 0) end)
    ptpJointSpaceAngles(90, -90, 90, 0, 90, 0)
    """
    plain = run_text(tmp_path, text)
    handled = run_text(tmp_path, text, io=tmp_path / 'plc.yaml')
    assert handled.ok
    (on, _), (off, _) = outputs(handled)
    assert on == pytest.approx(0.5, abs=PERIOD)
    assert off - on == pytest.approx(1.0, abs=1e-9)
    # It stands before the handler ends: braking takes at least the ramp of 0.2 s.
    standing = (handled.time > on + 0.8) & (handled.time < off)
    assert not handled.reference[standing, 1].any()
    assert handled.motions[0].ok
    assert handled.duration > plain.duration + 1.0


def test_a_map_gives_names_and_fail_safe_values(tmp_path: Path):
    (tmp_path / 'map.yaml').write_text(
        'signals: {door_closed: digital_input.2}\n'
        'inputs:\n'
        '  - {channel: door_closed, topic: a, type: Bool, timeout: 0.5, fail_safe: true}\n'
        '  - {channel: analog_input.1, topic: b, type: Float64, timeout: 0.5, fail_safe: 2.5}\n'
        '  - {channel: digital_input.1, topic: c, type: Bool}\n'
    )
    text = 'print(tostring(getDigitalInput(1)) .. tostring(getDigitalInput(2)) .. getAnalogInput(1))'
    run = run_text(tmp_path, text, io_map=tmp_path / 'map.yaml', bag=tmp_path / 'bag')
    assert run.printed == ('falsetrue2.5',)
    found = read_bag(tmp_path / 'bag').deserialized(['/digital_inputs', '/parameter_events'])
    assert found['/digital_inputs'][0][1].data.tolist() == [0, 1]
    (event,) = (message for _, message in found['/parameter_events'])
    assert event.new_parameters[0].value.string_array_value == ['', 'door_closed']


def test_a_map_and_a_script_that_set_the_same_inputs_are_refused(tmp_path: Path):
    (tmp_path / 'map.yaml').write_text('inputs: [{channel: digital_input.9, topic: a, type: Bool}]')
    io = PROGRAMS / 'io' / 'press_tending.yaml'
    with pytest.raises(RobotsError, match='both set digital_inputs; only one can publish that topic'):
        run_text(tmp_path, 'wait(1)', io=io, io_map=tmp_path / 'map.yaml')


def test_a_motion_begins_at_once_although_the_plc_does_something_later(tmp_path: Path):
    program, rules = tmp_path / 'move.lua', tmp_path / 'plc.yaml'
    program.write_text('ptpJointSpaceAngles(20, -90, 90, 0, 90, 0)')
    rules.write_text('rules: [{when: start, after: 5, set: {digital_input.1: 1}}]')
    alone = simulate(program, robot=ROBOT, drive='ideal')
    beside = simulate(program, robot=ROBOT, drive='ideal', io=rules)
    np.testing.assert_array_equal(beside.reference, alone.reference)
    assert beside.duration == alone.duration
