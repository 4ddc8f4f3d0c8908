"""Motions that inputs interrupt, and outputs on the path, with planner, controller and drives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model

from .simulated_program import PERIOD, ROBOT, outputs, run_text

MODEL = load_robot_model(ROBOT)
START, TARGET = np.array([0, -90, 90, 0, 90, 0]), np.array([60, -60, 70, 0, 60, 0])  # deg
HOME = 'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
AWAY = 'ptpJointSpaceAngles(60, -60, 70, 0, 60, 0)\n'
SWITCHED = 0.6  # s, while the robot is on its way
PLC = f'rules: [{{when: digital_output.8 rises, after: {SWITCHED}, set: {{digital_input.1: 1}}}}]'


def interrupted(tmp_path: Path, handler: str, then: str = '') -> SimulationRun:
    """A motion away from home during which input 1 rises."""
    (tmp_path / 'plc.yaml').write_text(PLC)
    text = f'{HOME}onDigitalInput(1, true, function() {handler} end)\nsetDigitalOutput(8, 1)\n{AWAY}{then}'
    run = run_text(tmp_path, text, io=tmp_path / 'plc.yaml')
    assert run.ok, run.error
    check(run)
    return run


def parts(run: SimulationRun) -> np.ndarray:
    """How far the references are on the way from home, (k,), 0..1."""
    return run.reference[:, 0, 0] / np.radians(60.0)


def check(run: SimulationRun) -> None:
    """All references keep their limits, and are on the straight line in joint space from home."""
    axes = MODEL.axes_data
    values = run.reference[run.time >= run.motions[0].ended]
    assert (np.abs(values[:, 1]) <= axes.velocity * (1.0 + 1e-6)).all()
    assert (np.abs(values[:, 2]) <= axes.acceleration * (1.0 + 1e-6)).all()
    moved = TARGET != START
    turned = (np.degrees(values[:, 0]) - START)[:, moved] / (TARGET - START)[moved]
    assert np.ptp(turned, axis=1).max() < 1e-6


def test_an_input_interrupts_the_motion_which_then_goes_on(tmp_path: Path):
    run = interrupted(tmp_path, 'setDigitalOutput(1, 1) wait(1) setDigitalOutput(1, 0)')
    _, (began, _), (ended, _) = outputs(run)
    assert ended - began == pytest.approx(1.0, abs=1e-9)
    # It brakes when the handler begins, and stands once, on the path, until the handler's second is over.
    at = parts(run)
    stands = ~run.reference[:, 1].any(axis=1) & (at > 0.01) & (at < 0.99)
    times = run.time[stands]
    assert began < times[0] < ended <= times[-1] + PERIOD
    assert np.ptp(at[stands]) < 1e-12
    assert [motion.message for motion in run.motions] == ['reached', 'reached']
    np.testing.assert_allclose(np.degrees(run.reference[-1, 0]), TARGET, atol=1e-9)


def test_a_handler_that_aborts_ends_the_motion_where_it_stands(tmp_path: Path):
    run = interrupted(tmp_path, 'return "abort"', f'setDigitalOutput(2, 1)\n{HOME}')
    _, (after, _) = outputs(run)
    stood = np.searchsorted(run.time, after, side='right') - 1
    assert not run.reference[stood, 1].any()
    assert 0.01 < parts(run)[stood] < 0.99
    assert [motion.ok for motion in run.motions] == [True, False, True]
    np.testing.assert_allclose(np.degrees(run.reference[-1, 0]), START, atol=1e-9)


def test_a_handler_that_moves_ends_the_motion_and_it_is_commanded_anew(tmp_path: Path):
    run = interrupted(tmp_path, HOME.strip())
    assert [motion.ok for motion in run.motions] == [True, False, True, True]
    at = parts(run)
    home_again = np.searchsorted(run.time, run.motions[2].ended)
    farthest = at[:home_again].max()
    assert 0.01 < farthest < 0.99
    assert at[home_again] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(np.degrees(run.reference[-1, 0]), TARGET, atol=1e-9)


def test_outputs_switch_at_their_places_on_the_path(tmp_path: Path):
    places, speed = np.arange(0.05, 0.40, 0.05), 0.2  # m, m/s
    switches = ', '.join(
        f'{{distance_after_start = {place:.2f}, output = 1, value = {(number + 1) % 2}}}'
        for number, place in enumerate(places)
    )
    line = f'linearRelative({{0, 0, -0.45, 0, 0, 0}}, {{on_path = {{{switches}}}}})'
    run = run_text(tmp_path, f'{HOME}setSpeed(nil, {speed})\n{line}')
    assert run.ok, run.error
    here = run.time >= run.motions[0].ended
    r = np.array([MODEL.direct_kinematics(q)[0] for q in run.reference[here, 0]])
    way = np.linalg.norm(r - r[0], axis=1)
    changes = outputs(run)
    assert [value for _, value in changes] == [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]
    late = (np.interp([time for time, _ in changes], run.time[here], way) - places) / speed  # s
    # The controller's moving average lags by 10 ms behind the plan by which outputs switch.
    assert np.abs(late).max() < 0.010 + 2 * PERIOD


def test_a_more_urgent_handler_interrupts_another_and_the_motion_waits_for_both(tmp_path: Path):
    (tmp_path / 'plc.yaml').write_text(
        'rules:\n'
        f'  - {{when: digital_output.8 rises, after: {SWITCHED}, set: {{digital_input.1: 1}}}}\n'
        f'  - {{when: digital_output.8 rises, after: {SWITCHED + 0.5}, set: {{digital_input.2: 1}}}}\n'
    )
    text = f"""{HOME}
        onDigitalInput(1, true, function() wait(1) setDigitalOutput(1, 1) end)
        onDigitalInput(2, true, function() {HOME} setDigitalOutput(2, 1) end, 1)
        setDigitalOutput(8, 1)
        {AWAY}"""
    run = run_text(tmp_path, text, io=tmp_path / 'plc.yaml')
    assert run.ok, run.error
    check(run)
    _, (inner, _), (outer, _) = outputs(run)
    between = (run.time > inner) & (run.time < outer)
    assert outer - inner == pytest.approx(0.5, abs=0.01)  # the rest of its second
    assert np.abs(parts(run)[between]).max() < 1e-12
    np.testing.assert_allclose(np.degrees(run.reference[-1, 0]), TARGET, atol=1e-9)


def test_an_output_at_the_arrival_switches_as_one_at_the_end_of_the_path(tmp_path: Path):
    first, second = (
        'linearRelative({0, 0, -0.2, 0, 0, 0}, {blend = 0.03',
        'linearRelative(0, 0.2, 0, 0, 0, 0)',
    )
    on_path = f'{first}, on_path = {{time_before_end = 0, output = 1, value = 1}}}}) {second}'
    arrival = f"{first}}}) setDigitalOutput(1, 1, 'arrival') {second} setDigitalOutput(1, 0, 'arrival')"
    runs = [run_text(tmp_path, HOME + text) for text in (on_path, arrival)]
    (at_end, _), (at_arrival, _), (standing, _) = (*outputs(runs[0]), *outputs(runs[1]))
    assert at_arrival == at_end < standing == runs[1].motions[-1].ended
