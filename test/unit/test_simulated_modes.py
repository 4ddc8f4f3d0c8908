"""Operating modes of a simulated cell."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.errors import RobotsError

ROBOT = 'kuka_kr210_r2700'


def run(folder: Path, mode: str) -> SimulationRun:
    program = folder / 'program.lua'
    program.write_text('ptpJointSpaceAngles(30, -80, 90, 0, 60, 0)\n')
    return simulate(program, robot=ROBOT, operating_mode=mode)


def test_no_program_runs_in_remote(tmp_path: Path) -> None:
    refused = run(tmp_path, 'REMOTE')
    assert not refused.ok
    assert 'REMOTE' in str(refused.error)


def test_t1_is_slower_than_the_programmed_speed_of_t2_and_automatic(tmp_path: Path) -> None:
    slow, tested, produced = (run(tmp_path, mode) for mode in ('T1', 'T2', 'AUTOMATIC'))
    assert slow.ok
    assert tested.ok
    assert produced.ok
    assert tested.duration == produced.duration
    assert slow.duration > 2.0 * tested.duration


def test_an_unknown_mode_is_refused_with_the_valid_ones(tmp_path: Path) -> None:
    with pytest.raises(RobotsError, match=r'T3.*AUTOMATIC.*T1.*T2.*REMOTE'):
        run(tmp_path, 'T3')
