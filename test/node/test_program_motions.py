"""Programs with the nodes of planner, controller and drives: interrupts, aborts and stops reach the robot.

What the motions are like is judged in test/unit/test_interrupted_motions.py, on a simulated clock.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .program_cell import CRAWL, MOVE, TARGET, ProgramCell


@pytest.fixture
def cell(ros_nodes: Any, tmp_path: Path) -> ProgramCell:
    return ProgramCell(ros_nodes, tmp_path)


def test_an_input_interrupts_the_motion_which_then_goes_on(cell: ProgramCell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() setDigitalOutput(1, 1)'
        ' while getDigitalInput(1) do wait(0.01) end setOverride(1) end)\n' + CRAWL + MOVE
    )
    cell.until_moving()
    cell.set_input(1)
    cell.wait(lambda: cell.outputs[-1][0] == 1, 'the handler')
    cell.until_standing()
    assert not cell.results
    cell.set_input(0)
    cell.end('FINISHED')
    cell.wait(lambda: [result.message for result in cell.results] == ['reached'], 'the result')
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-9)


def test_a_handler_that_aborts_ends_the_motion(cell: ProgramCell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() setOverride(1) return "abort" end)\n'
        + CRAWL
        + 'ptpJointSpaceAngles(60, -60, 70, 0, 60, 0)\n'
        + MOVE
    )
    cell.until_moving()
    cell.set_input(1)
    cell.end('FINISHED')
    cell.wait(lambda: [result.ok for result in cell.results] == [False, True], 'the results')
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-9)


def test_a_stop_leaves_the_robot_on_its_path_and_the_program_runs_again(cell: ProgramCell) -> None:
    cell.start('if getDigitalInput(1) then setOverride(1) else setOverride(0.002) end\n' + MOVE)
    cell.until_moving()
    cell.command('stop')
    cell.end('STOPPED')
    cell.wait(lambda: [result.ok for result in cell.results] == [False], 'the result')
    assert cell.until_standing()[0] < TARGET[0] - 1.0
    cell.set_input(1)
    cell.command('run')
    cell.end('FINISHED')
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-9)


def test_a_stop_of_the_robot_ends_a_program_that_catches_errors_and_holds_until_its_reset(
    cell: ProgramCell,
) -> None:
    cell.start(CRAWL + 'while true do pcall(ptpJointSpaceAngles, 60, -60, 70, 0, 60, 0) end\n')
    cell.until_moving()
    assert cell.call('controller_node/stop').success
    cell.end('FAILED')
    assert 'stop by ~/stop' in cell.status[-1]['error']
    cell.until_standing()
    refused = cell.call('lua_program_node/run')
    assert not refused.success
    assert 'stop by ~/stop' in refused.message
    assert cell.call('controller_node/reset').success
    cell.wait(lambda: cell.call('lua_program_node/run').success, 'a program that may run')
    cell.until_moving()
    cell.command('stop')
    cell.end('STOPPED')
