"""The program of debris removal: what it does when the target cannot be grasped, and what its plots say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from debris_removal.recorded_bodies import ROBOT, describe, read_bodies
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.errors import RobotsError

from .simulated_program import PROGRAMS

PROGRAM = PROGRAMS / 'debris_removal.lua'
ORBIT = PROGRAMS / 'debris_removal' / 'orbit.yaml'


def run_with(folder: Path, old: str, new: str) -> SimulationRun:
    """Simulate the program, cheaply, in another orbit."""
    text = ORBIT.read_text()
    assert text.count(old) == 1
    (folder / 'orbit.yaml').write_text(text.replace(old, new))
    program = folder / 'program.lua'
    program.write_text(
        PROGRAM.read_text().replace('PATIENCE, STEADYING = 60, 120', 'PATIENCE, STEADYING = 6, 1')
    )
    return simulate(
        program, robot=ROBOT, drive='ideal', rate=50.0, orbit=folder / 'orbit.yaml', bag=folder / 'bag'
    )


def test_a_target_that_tumbles_too_fast_is_not_approached(tmp_path: Path) -> None:
    run = run_with(tmp_path, '[0.035, 0.004, 0.002]', '[0.1, 0.004, 0.002]')
    assert 'grasp refused at ' in str(run.error)
    assert '5.74 degrees/s' in str(run.error)
    bodies = read_bodies(tmp_path / 'bag')
    assert bodies.report == 'grasp refused: the target turns at 0.1001 rad/s, the gripper holds 0.06 rad/s'
    assert np.abs(bodies.drift).max() < 1e-9
    assert 'grasped: never' in describe(bodies)


def test_without_the_camera_the_arm_stands_and_the_program_says_so(tmp_path: Path) -> None:
    run = run_with(tmp_path, 'camera_range: 4.0', 'camera_range: 3.0')
    assert 'the ring was not reached within 6 s' in str(run.error)
    moved = np.abs(run.reference[run.time > 3.0, 0] - run.reference[-1, 0])
    assert moved.max() < 1e-6


def test_a_signal_that_stops_on_the_way_stops_the_arm(tmp_path: Path) -> None:
    """The chaser drifts away until its camera does not see the ring any more."""
    run = run_with(tmp_path, 'camera_range: 4.0}', 'camera_range: 3.45}\ntwist: [-0.05, 0, 0, 0, 0, 0]')
    assert 'the ring was not reached within 6 s' in str(run.error)
    guided = run.time > 2.5
    assert np.abs(run.reference[guided, 1]).max() > 0.01
    assert not run.reference[-1, 1].any()


def test_only_one_sets_inputs_or_guides(tmp_path: Path) -> None:
    plc = tmp_path / 'plc.yaml'
    plc.write_text('rules:\n  - {when: start, set: {digital_input.4: 1}}\n')
    with pytest.raises(RobotsError, match=r'orbit.yaml and .*plc.yaml both set inputs'):
        simulate(PROGRAM, robot=ROBOT, orbit=ORBIT, io=plc)
    with pytest.raises(RobotsError, match='both guide the robot'):
        simulate(PROGRAM, robot=ROBOT, orbit=ORBIT, references=tmp_path)
