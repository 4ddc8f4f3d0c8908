"""GoalWatch: a goal is given up when the driver or the robot falls silent."""

from __future__ import annotations

from robots_controller.cell.goal_watch import ANSWER_PATIENCE, GoalWatch

LATE = ANSWER_PATIENCE + 0.1


def executed() -> GoalWatch:
    watch = GoalWatch('/sequence')
    watch.measured(1, 0.0)
    watch.sent(0.0)
    watch.answered(accepted=True)
    return watch


def test_a_goal_that_is_not_answered_is_given_up() -> None:
    watch = GoalWatch('/sequence')
    assert not watch.problem(LATE, served=False)
    watch.sent(1.0)
    assert not watch.problem(LATE, served=True)
    assert watch.problem(1.0 + LATE, served=True) == '/sequence has not answered for 2 s'
    watch.ended()
    assert not watch.problem(10.0, served=False)


def test_a_goal_whose_action_is_gone_is_given_up() -> None:
    watch = executed()
    assert not watch.problem(1.0, served=True)
    assert watch.problem(1.0, served=False) == '/sequence is not served any more'
    watch.ended()
    assert not watch.problem(1.0, served=False)


def test_a_robot_that_moves_must_be_heard() -> None:
    watch = executed()
    watch.measured(1, 1.0)  # the same as before
    assert watch.problem(LATE, served=True) == 'no joint_states for 2 s while the robot moves'
    watch.measured(2, LATE)
    assert not watch.problem(LATE, served=True)
