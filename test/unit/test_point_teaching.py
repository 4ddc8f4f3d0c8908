"""Points that a service teaches."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cell_double import CellDouble
from robots_controller.cell.point_teaching import PointTeaching
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.files.taught_points import read_points
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.run_state import RunState
from robots_core import load_robot_model
from robots_core.errors import NotNowError, ProgramError, RobotsError

ROBOT = load_robot_model('cello_bot')
HOME = JointFeedback(np.array(ROBOT.home), np.full(ROBOT.num_axes, 1e-4))


class Opened:
    """A program that is open, and its points file."""

    def __init__(self, folder: Path) -> None:
        self.program = LuaProgram(ROBOT.num_axes, CellDouble())
        self.teaching = PointTeaching(ROBOT, self.program)
        path = folder / 'part.lua'
        path.write_text('')
        self.program.open(path)
        self.file = path.with_suffix('.points.yaml')


@pytest.fixture
def opened(tmp_path: Path) -> Opened:
    return Opened(tmp_path)


def test_points_get_free_names_or_their_own(opened: Opened, tmp_path: Path) -> None:
    assert opened.teaching.teach('', HOME) == 'P1 is where the robot stands, in part.points.yaml'
    opened.teaching.teach('', HOME)
    opened.teaching.teach('pallet', HOME)
    moved = JointFeedback(HOME.position + 0.1)
    opened.teaching.teach('P1', moved)  # touched up
    points = read_points(opened.file, ROBOT.num_axes)
    assert sorted(points) == ['P1', 'P2', 'pallet']
    np.testing.assert_allclose(points['P1'].q, moved.position)
    opened.program.points_file = tmp_path / 'other.yaml'
    assert opened.teaching.teach('', HOME).startswith('P1 ')


def test_nothing_is_taught_where_the_robot_does_not_stand(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    moving = JointFeedback(HOME.position, np.full(ROBOT.num_axes, 0.1))
    cases: list[tuple[Any, type[RobotsError], str]] = [
        (None, ProgramError, 'no joint_states received'),
        (moving, NotNowError, 'the robot moves'),
    ]
    for measured, kind, message in cases:
        with pytest.raises(kind, match=message):
            opened.teaching.teach('P1', measured)
    monkeypatch.setattr(opened.program, 'run_state', RunState.RUNNING)
    with pytest.raises(NotNowError, match=r'part\.lua runs; pause or stop it'):
        opened.teaching.teach('P1', HOME)
    with pytest.raises(ProgramError, match='no program is open'):
        PointTeaching(ROBOT, LuaProgram(ROBOT.num_axes, CellDouble())).teach('P1', HOME)
    assert not opened.file.exists()


def test_a_broken_points_file_stays_as_it_is(opened: Opened) -> None:
    opened.file.write_text('points:\n  P1: {q: [0,\n')
    with pytest.raises(ProgramError, match=r'part\.points\.yaml:3:'):
        opened.teaching.teach('P2', HOME)
    assert opened.file.read_text() == 'points:\n  P1: {q: [0,\n'
