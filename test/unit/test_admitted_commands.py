"""AdmittedCommands: what is under way is given up with the commander that has commanded it."""

from __future__ import annotations

import pytest

from robots_core.cell_interface.operating_modes import Commander
from robots_planning.commands.admitted_commands import AdmittedCommands
from robots_planning.motion_settings import MotionSettings

from .planner_cell import Cell

BLENDS = MotionSettings(joint_blend_zone=0.1)
OTHERS = [commander for commander in Commander if commander is not Commander.NOBODY]


@pytest.fixture
def cell() -> Cell:
    return Cell()


def held(cell: Cell, commander: Commander) -> AdmittedCommands:
    """A command of this commander waits for one that it blends into."""
    admitted = AdmittedCommands(cell.planner)
    admitted.admit(commander)
    cell.move('1', 0.2, BLENDS)
    assert not cell.sent
    cell.now += 0.1
    return admitted


@pytest.mark.parametrize('commander', OTHERS)
def test_another_one_takes_the_robot(cell: Cell, commander: Commander) -> None:
    admitted = held(cell, commander)
    admitted.taken(commander)
    assert cell.planner.holds('1')
    admitted.taken(next(other for other in OTHERS if other is not commander))
    assert not cell.sent
    assert 'has taken the robot' in cell.answers[0].message


@pytest.mark.parametrize('commander', OTHERS)
def test_the_commander_is_lost(cell: Cell, commander: Commander) -> None:
    admitted = held(cell, commander)
    admitted.lost(next(other for other in OTHERS if other is not commander), 'another is silent')
    assert cell.planner.holds('1')
    admitted.lost(commander, 'it is silent')
    assert not cell.sent
    assert 'it is silent' in cell.answers[0].message


@pytest.mark.parametrize('commander', OTHERS)
def test_the_robot_is_stopped(cell: Cell, commander: Commander) -> None:
    admitted = held(cell, commander)
    admitted.stopped('emergency stop', cell.now)
    given_up = [result.message for result in cell.answers]
    assert not cell.sent
    # A program gives up its motions itself.
    assert given_up == [] if commander is Commander.PROGRAM else 'emergency stop' in given_up[0]
