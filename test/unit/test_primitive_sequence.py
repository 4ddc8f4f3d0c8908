"""PrimitiveSequence: checked before it begins, and ended by its last motion or its first failure."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, PlanningError
from robots_planning.commands.goal_outcome import INVALID_GOAL, SUCCESSFUL, Outcome
from robots_planning.commands.motion_primitives import MOST_PRIMITIVES, MotionPrimitive
from robots_planning.commands.primitive_sequence import Command, PrimitiveSequence, checked_commands
from robots_planning.motion_kinds import JOINT

from .planner_cell import PLAIN, ROBOT, START, Cell

IDS = ['1', '2', '3']


def primitive(turn: float, **arguments: float) -> MotionPrimitive:
    """A joint motion from `START` by an angle, which blends."""
    return MotionPrimitive(JOINT, START + turn, 0.02, arguments)


def commands(*primitives: MotionPrimitive) -> list[Command]:
    return checked_commands(primitives, lambda one: one, ROBOT, PLAIN)


@pytest.fixture
def cell() -> Cell:
    return Cell()


@pytest.fixture
def sequence(cell: Cell) -> PrimitiveSequence:
    """Three motions under way."""
    found = PrimitiveSequence(cell.planner)
    found.begin(commands(*(primitive(0.1 * k) for k in (1, 2, 3))), IDS)
    return found


def end(sequence: PrimitiveSequence, id_: str, message: str = 'reached') -> bool:
    return sequence.ended(MotionResult(id_, ok=message == 'reached', message=message))


def test_only_the_last_motion_stops() -> None:
    zones = [settings.joint_blend_zone for _, settings in commands(primitive(0.1), primitive(0.2))]
    assert zones[0] > 0.0
    assert zones[1] == 0.0


@pytest.mark.parametrize('count', [0, MOST_PRIMITIVES + 1])
def test_too_few_and_too_many_are_refused(count: int) -> None:
    with pytest.raises(InvalidInputError, match=f'a sequence needs 1 to 255 primitives, got {count}'):
        commands(*[primitive(0.1)] * count)


def test_the_first_primitive_that_is_not_valid_is_named() -> None:
    with pytest.raises(InvalidInputError, match=r'^primitive 1: velocity = -1 must be a number above 0'):
        commands(primitive(0.1), primitive(0.2, velocity=-1.0), primitive(0.3, velocity=-2.0))


def test_a_sequence_does_not_begin_while_the_robot_moves(cell: Cell, sequence: PrimitiveSequence) -> None:
    assert sequence.moves
    later = PrimitiveSequence(cell.planner)
    with pytest.raises(PlanningError, match='the robot is still moving'):
        later.begin(commands(primitive(0.1)), ['9'])
    assert not later.moves
    assert not cell.planner.holds('9')


def test_it_ends_with_its_last_motion(sequence: PrimitiveSequence) -> None:
    assert [end(sequence, id_) for id_ in IDS] == [False, False, True]
    assert not sequence.moves
    assert sequence.outcome == Outcome(SUCCESSFUL, 'reached')


def test_the_first_failure_counts(sequence: PrimitiveSequence) -> None:
    end(sequence, '1')
    end(sequence, '2', 'drive fault')
    assert sequence.moves
    assert end(sequence, '3', 'given up')
    assert sequence.outcome == Outcome(INVALID_GOAL, 'primitive 1: drive fault')


def test_each_primitive_is_reported_once_when_the_robot_is_on_its_path(
    cell: Cell, sequence: PrimitiveSequence
) -> None:
    cell.planner.end_wait()
    assert len(cell.planner.motions) == 1
    found = [sequence.advanced(progress) for progress in np.linspace(0.0, 0.999, 200)]
    assert [index for index in found if index is not None] == [0, 1, 2]
    assert sequence.advanced(0.0) is None


def test_what_is_given_up_before_it_is_planned_does_not_begin(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    work: list[Callable[[], None]] = []
    monkeypatch.setattr(cell, 'submit', work.append)
    sequence = PrimitiveSequence(cell.planner)
    assert not sequence.give_up()  # there is nothing to stop
    sequence.begin(commands(primitive(0.1), primitive(0.2)), IDS[:2])
    cell.now += 1.0
    assert sequence.give_up()
    for plan in work:
        plan()
    assert not cell.sent
    assert [sequence.ended(result) for result in cell.answers] == [False, True]
    assert sequence.outcome == Outcome(INVALID_GOAL, 'primitive 0: given up: its goal was stopped')
