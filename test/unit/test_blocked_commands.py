"""MotionPlanner: a motion that the controller has stopped before a collision."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from robots_core.cell_interface.motion_result import BLOCKED, MotionResult
from robots_core.errors import InvalidInputError
from robots_core.validation import Array
from robots_planning import MotionSettings
from robots_planning.commands.command_queue import WINDOW
from robots_planning.motion_kinds import JOINT

from .planner_cell import MIDDLE, PLAIN, START, Cell

CORNER = START + np.array([0.1, 0.3, 0.1, 0.1, 0.1, 0.1])
REPLANS = MotionSettings(avoid=True, on_blocked='replan', most_replans=2)


@pytest.fixture
def cell() -> Cell:
    return Cell()


def blocked(cell: Cell, id_: str, progress: float, q: Array) -> None:
    """The controller has stopped a motion before an obstacle."""
    cell.now += 1.0
    cell.q = q
    cell.planner.result(
        MotionResult(id_, ok=False, message=BLOCKED, details={'progress': str(progress)}, blocked=True),
        cell.now,
    )


def test_a_blocked_motion_is_planned_anew_from_where_the_robot_stands_so_often(cell: Cell) -> None:
    cell.move('1', 0.4, REPLANS)
    for count in (1, 2):
        blocked(cell, '1', 0.3, START + 0.1 * count)
        assert cell.ids == ['1'] * (1 + count)
        np.testing.assert_array_equal(cell.trajectory(count).position[[0, -1]], [cell.q, START + 0.4])
    assert not cell.answers
    blocked(cell, '1', 0.3, START + 0.3)
    assert cell.ids == ['1'] * 3
    (result,) = cell.answers
    assert (result.id, result.ok, result.blocked) == ('1', False, False)
    assert result.message.startswith(
        'stopped before a collision again, after 2 replanned paths, as many as most_replans allows: '
    )
    assert not cell.planner.moving


@pytest.mark.parametrize(
    'settings', [PLAIN, replace(REPLANS, on_blocked='stop'), replace(REPLANS, avoid=False)]
)
def test_without_the_setting_a_blocked_motion_ends_with_what_is_in_the_way(
    cell: Cell, settings: MotionSettings
) -> None:
    cell.move('1', 0.4, settings)
    cell.move('2', 0.0, settings)
    blocked(cell, '1', 0.3, START + 0.1)
    blocked(cell, '2', 0.0, START + 0.1)  # waited behind it
    assert cell.ids == ['1', '2']
    assert [(result.id, result.ok) for result in cell.answers] == [('1', False), ('2', False)]
    assert cell.answers[0].message.startswith('stopped before a collision: ')


def test_a_line_that_is_blocked_is_not_left(cell: Cell) -> None:
    cell.line('1', 0.1, REPLANS)
    blocked(cell, '1', 0.3, START)
    assert cell.ids == ['1']
    assert [result.ok for result in cell.answers] == [False]


def test_what_was_passed_is_answered_and_the_rest_goes_on_in_its_order(cell: Cell) -> None:
    chained = replace(REPLANS, joint_blend_zone=0.02)
    cell.move('1', 0.1, chained)
    cell.planner.command('2', JOINT, CORNER, REPLANS)
    cell.move('3', 0.0, REPLANS)
    assert cell.ids == ['2', '3']
    first = cell.ends[0]['1'] / cell.trajectory(0).duration
    q = cell.trajectory(0).sample(0.5 * (1.0 + first) * cell.trajectory(0).duration)[0]
    blocked(cell, '2', 0.5 * (1.0 + first), q)
    blocked(cell, '3', 0.0, q)
    assert [(result.id, result.ok, result.message) for result in cell.answers] == [('1', True, 'passed')]
    assert cell.ids == ['2', '3', '2', '3']
    assert [[*ends] for ends in cell.ends] == [['1', '2'], ['3'], ['2'], ['3']]
    np.testing.assert_array_equal(cell.trajectory(2).position[0], q)
    np.testing.assert_array_equal(cell.trajectory(3).position[0], cell.trajectory(2).position[-1])
    cell.end('2')
    cell.end('3')
    assert not cell.planner.moving
    assert cell.told[-1]


def test_a_blocked_chain_goes_on_as_a_chain(cell: Cell) -> None:
    chained = replace(REPLANS, joint_blend_zone=0.02)
    cell.move('1', 0.1, chained)
    cell.planner.command('2', JOINT, CORNER, REPLANS)
    blocked(cell, '2', 0.1, START + 0.01)
    assert cell.ids == ['2', '2']
    assert [*cell.ends[1]] == ['1', '2']
    assert not cell.answers


def test_the_way_around_of_a_long_chain_has_the_id_of_the_motion_that_was_blocked(cell: Cell) -> None:
    cell.bead(*range(WINDOW + 1), settings=REPLANS)
    assert cell.ids == [MIDDLE]  # its plan may be carried on from there
    blocked(cell, MIDDLE, 0.0, START)
    assert cell.ids[1] == MIDDLE
    assert [*cell.ends[1]][-1] == MIDDLE
    assert not cell.answers


def test_where_there_is_no_way_around_all_is_given_up_that_was_commanded(cell: Cell) -> None:
    cell.move('1', 0.4, REPLANS)
    cell.move('2', 0.0, REPLANS)
    cell.q_dot[1] = 0.3  # a robot that still moves: nothing can be planned from there
    blocked(cell, '1', 0.3, START + 0.1)
    assert cell.ids == ['1', '2']
    assert [(result.id, result.ok) for result in cell.answers] == [('1', False), ('2', False)]
    assert 'attempt 1 of 2 to go around it failed: the robot is still moving' in cell.answers[0].message
    assert 'given up with motion 1' in cell.answers[1].message
    cell.q_dot[1] = 0.0
    cell.now += 1.0
    cell.move('3', 0.2)
    assert cell.ids[-1] == '3'


def test_a_motion_that_the_controller_does_not_let_go_on_has_failed(cell: Cell) -> None:
    cell.move('1', 0.4, REPLANS)
    blocked(cell, '1', 0.3, START + 0.1)
    assert cell.end('1', ok=False, progress='0')
    assert not cell.planner.moving
    assert not cell.answers  # the controller's result is the last one


def test_a_motion_that_is_blocked_while_another_is_planned_comes_before_it() -> None:
    class Busy(Cell):
        """Its planner is at work when the obstacle comes."""

        def submit(self, work: Callable[[], None]) -> None:
            self.works.append(work)

    cell = Busy.__new__(Busy)
    cell.works = []
    Cell.__init__(cell)
    cell.move('1', 0.4, REPLANS)
    cell.works.pop(0)()
    cell.move('2', 0.0, REPLANS)
    blocked(cell, '1', 0.3, START + 0.1)
    for work in cell.works:
        work()
    assert cell.ids == ['1', '1', '2']
    np.testing.assert_array_equal(cell.trajectory(2).position[0], START + 0.4)


def test_the_settings_of_blocked_motions_are_checked() -> None:
    with pytest.raises(InvalidInputError, match=r"on_blocked 'wait' is unknown; valid are stop and replan"):
        MotionSettings(on_blocked='wait')
    for count in (0, 101, 1.5, True):
        with pytest.raises(InvalidInputError, match=r'most_replans = .* whole number in \[1, 100\]'):
            MotionSettings(most_replans=count)  # type: ignore[arg-type]
