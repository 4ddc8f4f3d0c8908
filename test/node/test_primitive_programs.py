"""Robot programs that move a robot by motion primitives: another planner executes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from control_interfaces import control_msgs

from .program_cell import MOVE, TARGET, ProgramCell

__all__ = ['control_msgs']

SERVED = 'primitives: {name: /execute_motion_primitive_sequence}\n'
FIRST = 'ptpJointSpaceAngles(10, -85, 85, 0, 60, 0, {jointBlend = 5})\n'
ROUTE = f"""{FIRST}ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)
linearRelative(0, 0, -0.05, 0, 0, 0, {{blend = 0.01}})
linearRelative(0, 0.1, 0, 0, 0, 0, {{on_path = {{distance_after_start = 0.03, output = 2, value = true}}}})
local p = getCartesianPosition()
circCartesianSpace(offset(p, 0.1, 0.1, 0), offset(p, 0.2, 0, 0))
{MOVE}"""


def driver_file(folder: Path, text: str) -> str:
    path = folder / 'driver.yaml'
    path.write_text(text)
    return str(path)


@pytest.fixture(scope='module')
def cell(module_ros_nodes: Any, control_msgs: None, tmp_path_factory: pytest.TempPathFactory) -> ProgramCell:
    del control_msgs
    folder = tmp_path_factory.mktemp('served')
    return ProgramCell(module_ros_nodes, folder, driver=driver_file(folder, SERVED))


def test_a_program_moves_a_robot_by_primitives(cell: ProgramCell) -> None:
    cell.start(ROUTE)
    cell.end('FINISHED')
    assert cell.outputs[-1][1] == 1
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-3)
    corner = np.radians([10.0, -85.0, 85.0, 0.0, 60.0, 0.0])
    nearest = min(np.abs(np.array(one.positions) - corner).max() for one in cell.references)
    assert 1e-3 < nearest < np.radians(5.0)  # it runs through


def test_a_paused_program_stops_the_robot_and_goes_on(cell: ProgramCell) -> None:
    cell.start('setSpeed(0.01)\nptpJointSpaceAngles(0, -80, 80, 0, 60, 0)\nsetSpeed(1)\n' + MOVE)
    cell.until_moving()
    cell.command('pause')
    cell.until_standing()
    assert cell.status[-1]['state'] == 'PAUSED'
    cell.command('resume')
    cell.until_moving()
    cell.command('stop')
    cell.end('STOPPED')
    cell.wait(lambda: cell.program.host.program.motion is None, 'the end of the motion')


def test_a_motion_that_the_driver_refuses_ends_the_program_with_its_reason(cell: ProgramCell) -> None:
    assert cell.call('controller_node/emergency_stop').success
    cell.start(MOVE)
    cell.end('FAILED')
    assert '/execute_motion_primitive_sequence has ended the motion' in cell.status[-1]['error']
