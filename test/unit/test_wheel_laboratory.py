"""The wheel laboratory: what it measures, and what must stop its robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from robots_controller.cell.contact_setup import ContactSetup, read_contact
from robots_controller.program.files.program_header import read_program_header
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model
from robots_core.errors import RobotsError
from wheel_laboratory.recorded_wheel import ROBOT, WheelRun, read_runs

from .simulated_program import PROGRAMS

PROGRAM = PROGRAMS / 'wheel_laboratory.lua'
CONTACT = PROGRAMS / 'wheel_laboratory' / 'regolith_simulant.yaml'
REST = 'n: 1, cohesion: 800, friction: 0.65, shear_modulus: 0.036, c1: 0.4, c2: 0.15, rear_ratio: 0.9'
SHORTER = {
    '{0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8}': '{0.4}',
    'PRESSING, DRIVING = 3.5, 7': 'PRESSING, DRIVING = 1.7, 5',
    'NEAR, ABOVE = 0.02, 0.10': 'NEAR, ABOVE = 0.003, 0.03',
}


def changed_file(folder: Path, **sections: dict[str, Any]) -> Path:
    """The file of the program with other values in some sections."""
    values = yaml.safe_load(CONTACT.read_text())
    for name, section in sections.items():
        values[name] |= section
    path = folder / 'contact.yaml'
    path.write_text(yaml.safe_dump(values))
    return path


def simulated(
    folder: Path, *, changes: dict[str, str] | None = None, contact: Path = CONTACT, **options: Any
) -> SimulationRun:
    text = PROGRAM.read_text()
    for old, new in (SHORTER | (changes or {})).items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    path = folder / 'program.lua'
    path.write_text(text)
    return simulate(path, robot=ROBOT, contact=contact, drive='ideal', **options)


@pytest.fixture(scope='module')
def setup() -> ContactSetup:
    return read_contact(CONTACT)


@pytest.fixture(scope='module')
def measured(tmp_path_factory: pytest.TempPathFactory, setup: ContactSetup) -> WheelRun:
    folder = tmp_path_factory.mktemp('run')
    run = simulated(folder, changes={'64.68, 0.03 --': '64.68, 0.05 --'}, bag=folder / 'bag')
    assert run.ok, run.error
    axes, (_, q_dot, q_ddot) = load_robot_model(ROBOT).axes_data, np.moveaxis(run.reference, 1, 0)
    assert (np.abs(q_dot) <= axes.velocity).all()
    assert (np.abs(q_ddot) <= axes.acceleration * (1.0 + 1e-9)).all()
    (found,) = read_runs(folder / 'bag', setup)
    return found


def test_the_program_names_its_file() -> None:
    header = read_program_header(PROGRAM)
    assert (header.robot, Path(header.contact).resolve()) == (ROBOT, CONTACT)


def test_the_wanted_load_is_pressed_and_kept(measured: WheelRun) -> None:
    assert measured.wanted == 64.68
    before = (measured.time > measured.driving - 0.2) & (measured.time < measured.driving)
    np.testing.assert_allclose(measured.load[before], measured.wanted, rtol=1e-3)
    assert measured.load.max() < 1.001 * measured.wanted  # no overshoot
    # While it begins to roll it sinks by 4 mm in 2 s, for which a gain of 1e-3 (m/s)/N takes 2 N.
    driven = measured.time > measured.driving
    assert np.abs(measured.load[driven] - measured.wanted).max() < 3.0
    np.testing.assert_allclose(measured.steady('load'), measured.wanted, rtol=1e-3)


def test_the_wheel_slips_as_commanded(measured: WheelRun, setup: ContactSetup) -> None:
    speed, wheel = measured.steady('speed').mean(), measured.steady('wheel_speed').mean()
    assert speed == pytest.approx(0.05, rel=1e-3)
    assert 1.0 - speed / (setup.wheel.radius * wheel) == pytest.approx(measured.slip) == 0.4


def test_what_the_sensor_measures_is_what_the_model_gives(measured: WheelRun, setup: ContactSetup) -> None:
    model = setup.contact().model
    depth = model.sinkage(measured.wanted, measured.slip)
    forces = model.forces(depth, measured.slip)
    # The load settles to its wanted value to a thousandth.
    for name, expected in (
        ('sinkage', depth),
        ('drawbar_pull', forces.drawbar_pull),
        ('torque', forces.torque),
    ):
        np.testing.assert_allclose(measured.steady(name), expected, rtol=2e-3, err_msg=name)


def failed(run: SimulationRun, reason: str) -> None:
    assert run.error is not None
    assert reason in str(run.error)
    assert run.state == 'FAILED'
    # The robot stands, with its drives off.
    assert not run.reference[-1, 1:].any()


def test_soil_that_is_left_stops_the_robot(tmp_path: Path) -> None:
    contact = changed_file(tmp_path, bed={'y': [-0.6, -0.14]}, force_control={'travel': 0.03})
    run = simulated(tmp_path, contact=contact)
    failed(run, 'pressed 0.03 m far, as far as allowed; the force is 0.0 N, wanted are 64.68 N')
    robot = load_robot_model(ROBOT)
    # From the edge on it was lowered by the travel at most, after 12 mm of sinkage, and braked from 20 mm/s.
    lowest = min(robot.direct_kinematics(q)[0][2] for q in run.position[::25]) - 0.39
    assert 0.60 - 0.012 - 0.03 - 0.001 < lowest < 0.60


def test_a_wheel_that_is_pressed_beyond_the_limit_stops_the_robot(tmp_path: Path) -> None:
    deeper = 'command(LOAD, SPEED, slip)\n  linearRelative(0, 0, -0.05, 0, 0, 0)\n'
    run = simulated(tmp_path, changes={'command(LOAD, SPEED, slip)': deeper})
    failed(run, 'the force on the tool is 12')
    assert 'allowed are 120 N' in str(run.error)
    (stopped,) = [motion for motion in run.motions if not motion.ok]
    assert stopped.command.function == 'linearRelative'


def test_contact_that_nobody_planned_stops_the_robot(tmp_path: Path) -> None:
    run = simulated(tmp_path, changes={'over(NEAR, Y)': 'over(-0.05, Y)'})
    failed(run, 'contact that was not planned: the force on the tool is ')


@pytest.mark.parametrize(
    ('old', 'new', 'reason'),
    [
        ('LOAD, SPEED = 64.68', 'LOAD, SPEED = 150', 'a load of 150 N is commanded; valid is 0 to below'),
        ('LOAD, SPEED = 64.68, 0.03', 'LOAD, SPEED = 64.68, 1', 'a speed of 1 m/s is commanded; valid is'),
        ('{0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8}', '{0.99}', 'a slip of 0.99 is commanded; valid is 0 to 0.95'),
    ],
)  # fmt: skip
def test_commands_out_of_range_stop_the_robot(tmp_path: Path, old: str, new: str, reason: str) -> None:
    failed(simulated(tmp_path, changes={old: new}), reason)


def test_a_run_that_pressed_nothing_is_refused(tmp_path: Path, setup: ContactSetup) -> None:
    program = tmp_path / 'still.lua'
    program.write_text('wait(0.1)\n')
    simulate(program, robot=ROBOT, bag=tmp_path / 'bag')
    with pytest.raises(RobotsError, match='holds no run of the wheel laboratory'):
        read_runs(tmp_path / 'bag', setup)


@pytest.mark.parametrize(
    ('sections', 'reason'),
    [
        ({'wheel': {'radius': -0.1}}, r'contact.yaml:\d+: radius = -0.1 m must be a finite number above 0'),
        ({'wheel': {'hub': [0, 0]}}, r'hub must have shape \(3,\)'),
        ({'wheel': {'colour': 1}}, "unknown key 'colour'"),
        ({'bed': {'x': [2.0, 1.0]}}, 'x side of the soil bed = -1.0 m'),
        ({'force_control': {'gain': 0}}, 'gain = 0'),
        ({'force_control': {'drive': [0, 0, 1]}}, 'press and drive must be at right angles'),
        ({'outputs': {'load': 'digital_output.1'}}, 'load is digital_output.1; valid is an analog output'),
        ({'outputs': {'slip': 'slip'}}, "'slip' is no channel"),
    ],
)
def test_files_that_are_no_setup_are_refused(
    tmp_path: Path, sections: dict[str, dict[str, Any]], reason: str
) -> None:
    with pytest.raises(RobotsError, match=reason):
        read_contact(changed_file(tmp_path, **sections))


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('soil: clay', 'soil is one of regolith_simulant, dry_sand, or a mapping of k_c, k_phi, n,'),
        ('soil: {k_c: 1}', 'soil is one of'),
        (f'soil: {{k_c: 0, k_phi: .nan, {REST}}}', r'soil\[1\] is nan'),
    ],
)
def test_soils_that_are_none_are_refused(tmp_path: Path, text: str, reason: str) -> None:
    path = tmp_path / 'contact.yaml'
    path.write_text(CONTACT.read_text().replace('soil: regolith_simulant', text))
    with pytest.raises(RobotsError, match=reason):
        read_contact(path)


def test_a_soil_of_one_s_own_is_read(tmp_path: Path) -> None:
    path = tmp_path / 'contact.yaml'
    own = f'soil: {{k_c: 1370, k_phi: 8.14e+5, {REST}}}'
    path.write_text(CONTACT.read_text().replace('soil: regolith_simulant', own))
    assert read_contact(path).soil.friction == 0.65


def test_a_recording_and_force_control_do_not_guide_together(tmp_path: Path) -> None:
    with pytest.raises(
        RobotsError, match='both guide the robot: give a recording or a cabin, a contact or an orbit, not two'
    ):
        simulated(tmp_path, references=tmp_path / 'bag')


def test_nobody_jogs_a_robot_with_force_control(tmp_path: Path) -> None:
    program = tmp_path / 'jog.lua'
    program.write_text('jog(0.1)\n')
    run = simulate(program, robot=ROBOT, contact=CONTACT)
    assert 'a simulation has no teach box' in str(run.error)
