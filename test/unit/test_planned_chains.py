"""MotionPlanner: blended motions that become one plan, and long chains of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robots_core import Pose
from robots_planning import MotionSettings
from robots_planning.commands.command_planner import REPLACE_LEAD
from robots_planning.commands.command_queue import WINDOW
from robots_planning.commands.motion_planner import BLEND_PATIENCE
from robots_planning.motion_kinds import JOINT, LINE

from .planner_cell import MIDDLE, PLAIN, START, Cell, above

BLENDED = MotionSettings(blend_zone=0.02)


@pytest.fixture
def cell() -> Cell:
    return Cell()


def test_blended_motions_become_one_when_none_follows(cell: Cell) -> None:
    cell.line('1', 0.1, BLENDED)
    cell.planner.command('2', LINE, above(0.1) @ Pose(np.array([0.0, 0.1, 0.0]), np.eye(3)), BLENDED)
    assert not cell.sent
    assert cell.patience == [BLEND_PATIENCE, BLEND_PATIENCE]
    cell.planner.release()
    ((id_, _, title, _),) = cell.sent
    assert id_ == '2'
    assert title == 'PTPCARTESIAN + PTPCARTESIAN'
    cell.end('2')
    assert [(result.id, result.ok) for result in cell.answers] == [('1', True)]


def test_a_motion_that_does_not_blend_or_settings_that_do_not_end_a_chain(cell: Cell) -> None:
    cell.line('1', 0.05, BLENDED)
    cell.line('2', 0.1)
    assert cell.ids == ['2']
    cell.end('2')
    cell.line('3', 0.0, BLENDED)
    cell.planner.configure(BLENDED)
    assert cell.ids == ['2']
    cell.planner.configure(PLAIN)
    assert cell.ids == ['2', '3']


@pytest.mark.parametrize(('progress', 'passed'), [(0.01, False), (0.99, True)])
def test_of_a_chain_that_fails_what_was_passed_has_reached_its_target(
    cell: Cell,
    progress: float,
    passed: bool,  # noqa: FBT001
) -> None:
    cell.line('1', 0.1, BLENDED)
    cell.planner.command('2', LINE, above(0.1) @ Pose(np.array([0.0, 0.1, 0.0]), np.eye(3)), PLAIN)
    cell.end('2', ok=False, progress=str(progress))
    assert [(result.id, result.ok) for result in cell.answers] == [('1', passed)]


def test_a_chain_ends_where_the_payload_changes() -> None:
    cell = Cell()
    for number, payload in enumerate(((0.0, 0.0, 0.0, 0.0), (5.0, 0.0, 0.0, 0.1))):
        settings = replace(BLENDED, payload=payload)
        cell.planner.command(str(number), JOINT, START + 0.1 * (number + 1), settings)
    assert [id_ for id_, *_ in cell.sent] == ['0']


def test_a_long_chain_goes_on_from_the_middle_of_its_plan(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    assert cell.ids == [MIDDLE]  # the next plan may continue behind it
    cell.bead(*range(WINDOW + 1, WINDOW + 4), last=True)
    assert cell.ids == [MIDDLE, str(WINDOW + 3)]
    before, after = cell.trajectory(0), cell.trajectory(1)
    corner = before.duration + cell.sent[1][3]
    assert cell.ends[0][MIDDLE] == pytest.approx(corner, abs=1e-9)
    assert [*cell.ends[1]] == [str(number) for number in range(WINDOW // 2, WINDOW + 4)]
    for one, other in zip(before.sample(corner), after.sample(0.0), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-8)
    cell.end(MIDDLE)
    assert [(result.id, result.message) for result in cell.answers] == [
        (str(number), 'passed') for number in range(WINDOW // 2 - 1)
    ]
    assert cell.planner.moving
    cell.end(str(WINDOW + 3))
    assert len(cell.answers) == WINDOW + 2
    assert all(result.ok for result in cell.answers)
    assert cell.told[-1]


def test_what_comes_too_late_for_a_chain_starts_where_its_plan_stops(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.now += cell.ends[0][MIDDLE] - REPLACE_LEAD + 0.01
    cell.bead(WINDOW + 1, last=True)
    assert cell.ids == [MIDDLE, str(WINDOW + 1)]
    title, join_time = cell.sent[1][2:]
    assert title.endswith(' (its next motions came too late to be carried on in motion)')
    assert join_time == 0.0
    np.testing.assert_array_equal(cell.trajectory(1).position[0], cell.trajectory(0).position[-1])
    cell.end(MIDDLE)
    assert {result.id for result in cell.answers} == {str(number) for number in range(WINDOW)} - {MIDDLE}


def test_after_a_failure_no_plan_is_carried_on(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.end(MIDDLE, ok=False, progress='0.1')
    assert not cell.planner.moving
    cell.bead(WINDOW + 1, last=True)
    assert cell.sent[-1][3] == 0.0
    np.testing.assert_array_equal(cell.trajectory(-1).position[0], START)


def test_commands_that_others_may_follow_wait_as_long_as_the_plan_can_be_carried_on(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.planner.end_wait()
    assert len(cell.sent) == 1
    left = cell.ends[0][MIDDLE] - REPLACE_LEAD - BLEND_PATIENCE
    assert cell.patience[-1] == pytest.approx(left, abs=1e-9)
    cell.now += left + 1e-6
    cell.planner.end_wait()
    assert cell.ids == [MIDDLE, str(WINDOW)]
    assert cell.sent[1][3] < 0.0


def test_commands_behind_a_stop_wait_for_others_until_the_robot_stands(cell: Cell) -> None:
    cell.move('1', 0.2)
    cell.line('2', 0.1, BLENDED)
    cell.now += BLEND_PATIENCE
    cell.planner.end_wait()
    assert cell.ids == ['1']
    assert cell.patience[-1] == BLEND_PATIENCE
    cell.q = START + 0.2
    cell.end('1')
    cell.planner.end_wait()
    assert cell.ids == ['1', '2']


def test_every_command_of_a_chain_is_answered_when_the_robot_is_stopped(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1))
    cell.bead(WINDOW + 1, last=True)
    last = str(WINDOW + 1)
    assert cell.ids == [MIDDLE, last]
    cell.end(MIDDLE, ok=False, progress='0.0')
    cell.end(last, ok=False, progress='0.0')  # the controller gives it up with the one before it
    answers = {result.id: result.ok for result in cell.answers}
    assert answers == {
        str(number): False for number in range(WINDOW + 2) if str(number) not in {MIDDLE, last}
    }
