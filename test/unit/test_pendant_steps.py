"""Steps and targets that an operator commands."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pendant_desk import ME, READY, Desk
from robots_controller.pendant.jog.held_button import MOVE_KEY
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.permissions import NotPermittedError
from robots_core import Pose, load_robot_model
from robots_core.errors import InvalidInputError, RobotsError
from robots_planning.pathplanning import PathPlanning, PlannedMotion

OTHER = 'other'


def moves(desk: Desk) -> list[str]:
    """What was commanded, without signs that follow each other."""
    names = [call[0] + ('' if call[0] != 'hold_run' else f' {call[1]}') for call in desk.cell.calls]
    return [name for i, name in enumerate(names) if name != 'reference' and names[i - 1 : i] != [name]]


def standing_desk() -> Desk:
    robot = load_robot_model('cello_bot')
    q = np.array(robot.home)
    desk = Desk(replace(READY, q=q, tool=Pose(*robot.direct_kinematics(q))))
    desk.cell.reference = lambda: None  # type: ignore[attr-defined]
    return desk


def test_a_step_is_commanded_once_and_run_held_until_it_has_ended() -> None:
    desk = standing_desk()
    for _ in range(3):
        assert desk.hold(step=0.001) is None
    assert moves(desk) == ['begin_move', 'hold_run True']
    command, done = desk.cell.calls[0][1:]
    assert command.q[0] == pytest.approx(desk.robot.home[0] + 0.001)
    done(None)
    count = len(desk.cell.calls)
    desk.hold(step=0.001)
    desk.operator.release(ME)
    assert moves(desk)[-2:] == ['hold_run False', 'end_move']
    assert len(desk.cell.calls) == count
    desk.hold(2, step=0.001)
    assert moves(desk)[-2:] == ['begin_move', 'hold_run True']


def test_a_release_ends_a_step_and_its_late_end_is_no_failure() -> None:
    desk = standing_desk()
    desk.hold(step=0.001)
    desk.operator.release(ME)
    assert moves(desk) == ['begin_move', 'hold_run True', 'hold_run False', 'end_move']
    desk.cell.calls[0][2](RobotsError('stopped'))
    assert desk.operator.held.failure is None


def test_what_refuses_a_step_is_kept_for_its_viewer() -> None:
    desk = standing_desk()
    desk.hold(step=0.001)
    error = RobotsError('out of reach')
    desk.cell.calls[0][2](error)
    assert desk.operator.held.failure == (ME, error)
    assert moves(desk)[-1] == 'end_move'


def test_a_target_is_moved_to_after_its_preview() -> None:
    desk = standing_desk()
    with pytest.raises(NotPermittedError, match='no_preview'):
        desk.hold(key=MOVE_KEY)
    goal = np.array(desk.robot.home)
    goal[0] += 0.05
    found = desk.operator.preview(ME, 'joints', goal.tolist(), 0.5)
    assert found is not None
    assert found.duration > 0.0
    np.testing.assert_allclose(desk.cell.last[1], goal)
    for time, q in ((0.0, desk.robot.home), (found.duration, goal)):
        desk.operator.play_preview(ME, time)
        np.testing.assert_allclose(desk.cell.last[1], q)
    count = len(desk.cell.calls)
    desk.operator.play_preview(OTHER, 0.0)
    assert len(desk.cell.calls) == count
    desk.hold(2, key=MOVE_KEY)
    assert moves(desk)[-2:] == ['begin_move', 'hold_run True']
    desk.operator.give_back_control(ME)
    assert desk.cell.last == ('show_ghost', None)


def test_a_target_that_changes_while_it_is_planned_is_not_moved_to() -> None:
    desk = standing_desk()

    class Changing(PathPlanning):
        """Takes so long that the person types another target meanwhile."""

        def plan(self, *values: Any, **options: Any) -> PlannedMotion:
            desk.operator.forget_preview(ME)
            return super().plan(*values, **options)

    operator = PendantOperator(desk.robot, desk.cell, lambda: desk.time, lambda: Changing(desk.robot))
    operator.state, desk.operator = desk.operator.state, operator
    operator.take_control(ME)
    assert operator.preview(ME, 'joints', [*desk.robot.home], 0.5) is None
    assert desk.cell.calls == []
    with pytest.raises(NotPermittedError, match='no_preview'):
        desk.hold(key=MOVE_KEY)


@pytest.mark.parametrize('step', [-0.1, 0.6, float('nan')])
def test_odd_steps_are_refused(step: float) -> None:
    desk = standing_desk()
    with pytest.raises(InvalidInputError, match=r'step = .* must be above 0, at most 0\.5'):
        desk.hold(step=step)
    assert desk.cell.calls == []
