"""Operating modes of a simulated cell."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.controller_six_axes import ControllerSixAxes, ControllerStep
from robots_controller.program.run_state import RunState
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.cell_interface.operating_modes import OperatingMode
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


def test_a_program_is_paused_when_the_mode_with_run_held_is_left(tmp_path: Path) -> None:
    program = tmp_path / 'program.lua'
    program.write_text('wait(0.1)\nptpJointSpaceAngles(30, -80, 90, 0, 60, 0)\n')
    with ControllerSixAxes(ROBOT, program=program, operating_mode='T1') as controller:
        cell, q = controller._cell, np.array(controller.robot.home)

        def steps(count: int) -> list[ControllerStep]:
            return [controller.step(q) for _ in range(count)]

        steps(5)
        cell.controller.speed.authority.set_mode(OperatingMode.AUTOMATIC)
        cell._host.mode_changed(OperatingMode.AUTOMATIC)
        held = steps(100)[-1]
        assert (held.run_state, cell.program.hold_reason) == (RunState.PAUSED, 'pause')
        np.testing.assert_array_equal(held.references[0], q)
        cell._host.resume()
        moving = next(step for step in (controller.step(q) for _ in range(100)) if step.references[1].any())
        assert moving.run_state is RunState.RUNNING


def test_an_unknown_mode_is_refused_with_the_valid_ones(tmp_path: Path) -> None:
    with pytest.raises(RobotsError, match=r'T3.*AUTOMATIC.*T1.*T2.*REMOTE'):
        run(tmp_path, 'T3')
