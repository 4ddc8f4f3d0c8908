"""GoalWatch: a goal is given up when the driver or the robot falls silent, and then does not count."""

from __future__ import annotations

import pytest

from robots_controller.cell.goal_watch import ANSWER_PATIENCE, GoalWatch

LATE = ANSWER_PATIENCE + 0.1


@pytest.fixture
def watch() -> GoalWatch:
    found = GoalWatch('/sequence')
    found.measured(1, 0.0)
    return found


def execute(watch: GoalWatch) -> int:
    """Let the driver execute a goal; returns its number."""
    number = watch.sent(0.0)
    assert not watch.answered(number, accepted=True)
    assert watch.executes(number)
    return number


def test_a_goal_that_is_not_answered_is_given_up(watch: GoalWatch) -> None:
    assert not watch.problem(LATE, served=False)
    watch.sent(1.0)
    assert not watch.problem(LATE, served=True)
    assert watch.problem(1.0 + LATE, served=True) == '/sequence has not answered for 2 s'
    watch.ended()
    assert not watch.problem(10.0, served=False)


def test_a_goal_whose_action_is_gone_is_given_up(watch: GoalWatch) -> None:
    execute(watch)
    assert not watch.problem(1.0, served=True)
    assert watch.problem(1.0, served=False) == '/sequence is not served any more'
    watch.ended()
    assert not watch.problem(1.0, served=False)


def test_a_robot_that_moves_must_be_heard(watch: GoalWatch) -> None:
    execute(watch)
    watch.measured(1, 1.0)  # the same as before
    assert watch.problem(LATE, served=True) == 'no joint_states for 2 s while the robot moves'
    watch.measured(2, LATE)
    assert not watch.problem(LATE, served=True)


def test_a_goal_that_was_given_up_is_canceled_when_it_is_accepted(watch: GoalWatch) -> None:
    number = watch.sent(0.0)
    watch.give_up()
    assert watch.answered(number, accepted=True)
    assert not watch.executes(number)
    assert not watch.answered(number, accepted=False)
    assert not watch.problem(LATE, served=False)


def test_a_goal_that_was_canceled_before_its_answer_is_canceled_when_it_is_accepted(watch: GoalWatch) -> None:
    number = watch.sent(0.0)
    watch.cancel()
    assert watch.answered(number, accepted=True)
    assert watch.executes(number)  # until it has ended
    execute(watch)  # the next one is not canceled


def test_only_the_newest_goal_counts(watch: GoalWatch) -> None:
    before = execute(watch)
    number = execute(watch)
    assert not watch.executes(before)
    assert not watch.newest(before)
    assert watch.answered(before, accepted=True)
    watch.ended()
    assert not watch.executes(number)
    assert watch.newest(number)


def test_a_goal_that_is_refused_is_not_executed(watch: GoalWatch) -> None:
    number = watch.sent(0.0)
    assert not watch.answered(number, accepted=False)
    assert watch.newest(number)
    assert not watch.executes(number)
    assert not watch.problem(LATE, served=False)
