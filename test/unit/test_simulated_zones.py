"""Zones in a simulated cell: what a program meets there."""

from __future__ import annotations

from pathlib import Path

import pytest

from press_zone import PRESS_ZONE
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.errors import InvalidInputError

ROBOT = 'kuka_kr210_r2700'
PROGRAM = """\
ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)
ptpJointSpaceAngles(-40, -90, 90, 0, 60, 0)
"""


def run(folder: Path, zone: str, plc: str = '') -> SimulationRun:
    (folder / 'scene.yaml').write_text(zone)
    (folder / 'program.lua').write_text(PROGRAM)
    (folder / 'plc.yaml').write_text(plc)
    io = folder / 'plc.yaml' if plc else ''
    return simulate(folder / 'program.lua', robot=ROBOT, scene=folder / 'scene.yaml', io=io)


def test_a_program_that_crosses_a_border_fails_in_its_line(tmp_path: Path) -> None:
    error = str(run(tmp_path, PRESS_ZONE).error)
    assert error.startswith(
        "program.lua:2: ptpJointSpaceAngles: the motion crosses the border of zone 'press' after "
    )
    assert "mm inside zone 'press'" in error


def test_a_program_that_waits_before_a_zone_for_ever_ends_with_its_name(tmp_path: Path) -> None:
    closed = run(tmp_path, PRESS_ZONE + '    closed_by: {digital_input.1: off}\n')
    assert 'nothing lets it go on' in str(closed.error)
    assert "it is held before the border of zone 'press', which is closed" in str(closed.error)


def test_an_input_opens_a_zone(tmp_path: Path) -> None:
    zone = PRESS_ZONE + '    closed_by: {press_open: off}\n'
    plc = (
        'signals: {press_open: digital_input.3}\nrules:\n  - {when: start, after: 4, set: {press_open: 1}}\n'
    )
    waited = run(tmp_path, zone, plc)
    assert waited.ok
    assert waited.duration > 4.5


def test_a_zone_of_an_unknown_signal_is_reported(tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match=r"zone 'press': closed_by: 'press_open' is no channel"):
        run(tmp_path, PRESS_ZONE + '    closed_by: {press_open: off}\n')
