"""Stops by faults in a simulated cell: the program fails, and the robot stands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.control.stops.faults import Fault, StopCategory
from robots_controller.recording.bag_file import read_bag
from robots_controller.simulation.cell_parts import CellSetup, cell_parts
from robots_controller.simulation.simulated_cell import SimulatedCell
from robots_controller.simulation.simulation_run import SimulationRun

ROBOT = 'kuka_kr210_r2700'
TEXT = """
while true do
  ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)
  ptpJointSpaceAngles(-20, -80, 80, 0, 60, 0)
end
"""


def stopped(folder: Path, text: str, fault: Fault, at: float) -> SimulationRun:
    """A run that this fault ends at a time, s."""
    program = folder / 'program.lua'
    program.write_text(text)

    def trip(time: float, _line: int) -> None:
        if time >= at and not cell._cell.controller.stops.latched:
            cell._cell.control.loop.trip(fault, f'{fault.label}!')

    parts = cell_parts(CellSetup(program=program, robot=ROBOT))
    cell = SimulatedCell(parts, drive='second_order', bag=folder / 'bag', longest=20.0, on_progress=trip)
    return cell.run()


@pytest.mark.parametrize(
    'fault', [Fault.EMERGENCY_STOP, Fault.PLANNER_LOST, Fault.FEEDBACK_JUMPED], ids=lambda f: f.label
)
def test_a_fault_ends_the_program_and_the_robot_stands(tmp_path: Path, fault: Fault) -> None:
    run = stopped(tmp_path, TEXT, fault, at=0.5)
    assert run.state == 'FAILED'
    assert str(run.error) == f'program.lua:3: {fault.label}!'
    assert run.duration < 2.0
    assert np.abs(run.velocity[-1]).max() < (0.05 if fault is Fault.PLANNER_LOST else 1e-12)
    found = read_bag(tmp_path / 'bag').deserialized(['/stop_status', '/drives_on'])
    drives_on = [message.data for _, message in found['/drives_on']]
    assert drives_on[-1] == (fault.category is StopCategory.TWO)
    assert [status.message for _, status in found['/stop_status']][:2] == ['none', f'{fault.label}!']


def test_an_emergency_stop_ends_a_program_that_waits(tmp_path: Path) -> None:
    run = stopped(tmp_path, 'wait(15)', Fault.EMERGENCY_STOP, at=0.0)
    assert str(run.error) == 'program.lua:1: emergency stop!'
    assert run.duration < 1.0
