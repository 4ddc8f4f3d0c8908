"""TrajectoryGoal: when a goal is given up, and what its end is."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, JointNamesError
from robots_planning.commands.goal_outcome import (
    GOAL_TOLERANCE_VIOLATED,
    INVALID_GOAL,
    INVALID_JOINTS,
    PATH_TOLERANCE_VIOLATED,
    SUCCESSFUL,
    Outcome,
)
from robots_planning.commands.trajectory_goal import Errors, Tolerance, TrajectoryGoal

NAMES = ['A1', 'A2']
STILL, TARGET = np.zeros(2), np.array([0.3, 0.4])
REACHED = MotionResult('1', ok=True, message='reached')
FAULT = MotionResult('1', ok=False, message='drive fault', details={'progress': '0.4'})
BESIDE = MotionResult('1', ok=False, message='beside it', details={'progress': '1.0'})


def tolerance(position: float = -1.0, velocity: float = -1.0) -> Tolerance:
    return Tolerance.wanted([('A1', position, velocity)], NAMES, 'tolerance')


def goal(path: Tolerance | None = None, end: Tolerance | None = None, time: float = 0.0) -> TrajectoryGoal:
    found = TrajectoryGoal(NAMES, path or tolerance(), end or tolerance(), time)
    found.target = TARGET
    return found


def behind(error: float) -> Errors:
    """The first axis of the robot is behind the reference."""
    return np.array([error, 0.0]), STILL


def test_a_goal_is_given_up_beyond_its_path_tolerance() -> None:
    tracked = goal(path=tolerance(0.1))
    assert tracked.check(STILL, behind(0.1), 0.0) is None
    outcome = tracked.check(STILL, behind(0.11), 0.0)
    assert outcome is not None
    assert outcome.code == PATH_TOLERANCE_VIOLATED
    assert 'A1 is 0.11 from its reference' in outcome.message


def test_a_goal_is_given_up_when_the_robot_is_not_there_in_time_after_the_end_of_the_reference() -> None:
    tracked = goal(time=0.5)
    assert tracked.check(STILL, behind(0.1), 100.0) is None  # the reference is not at its end
    assert tracked.check(TARGET, behind(0.1), 200.0) is None
    assert tracked.check(TARGET, behind(0.1), 200.5) is None
    outcome = tracked.check(TARGET, behind(0.1), 200.6)
    assert outcome is not None
    assert outcome.code == GOAL_TOLERANCE_VIOLATED
    assert 'allowed is 0.5 s' in outcome.message
    assert goal().check(TARGET, behind(0.1), 1e9) is None  # any time
    before = goal(time=0.5)
    before.target = None
    assert before.check(TARGET, behind(0.1), 1e9) is None


@pytest.mark.parametrize(
    ('result', 'end', 'code', 'message'),
    [
        (REACHED, -1.0, SUCCESSFUL, 'reached'),
        (REACHED, 0.1, SUCCESSFUL, 'reached'),
        (REACHED, 0.01, GOAL_TOLERANCE_VIOLATED, 'the position of A1 is 0.05 from its reference'),
        (BESIDE, -1.0, GOAL_TOLERANCE_VIOLATED, 'beside it'),
        (BESIDE, 0.1, SUCCESSFUL, 'beside it'),  # what the client tolerates counts
        (FAULT, 0.1, PATH_TOLERANCE_VIOLATED, 'drive fault'),  # it is not at its end
    ],
)
def test_the_goal_tolerance_decides_at_the_end_of_the_path(
    result: MotionResult, end: float, code: int, message: str
) -> None:
    outcome = goal(end=tolerance(end)).outcome(result, behind(0.05))
    assert outcome.code == code
    assert outcome.message.startswith(message)


@pytest.mark.parametrize(
    ('result', 'code'),
    [(REACHED, SUCCESSFUL), (FAULT, PATH_TOLERANCE_VIOLATED), (BESIDE, GOAL_TOLERANCE_VIOLATED)],
)
def test_without_feedback_the_result_of_the_motion_counts(result: MotionResult, code: int) -> None:
    assert goal(end=tolerance(1e-9)).outcome(result, None) == Outcome(code, result.message)


def test_refusals_have_the_codes_of_the_action() -> None:
    assert Outcome.refused(JointNamesError('A3')) == Outcome(INVALID_JOINTS, 'A3')
    assert Outcome.refused(InvalidInputError('no points')) == Outcome(INVALID_GOAL, 'no points')


def test_zero_and_minus_one_are_no_tolerances() -> None:
    for none in (0.0, -1.0):
        assert not tolerance(none, none).given
    assert tolerance(0.2, 0.3).position.tolist() == [0.2, np.inf]
    assert tolerance(0.2, 0.3).velocity.tolist() == [0.3, np.inf]


@pytest.mark.parametrize('value', [-2.0, float('nan')])
def test_tolerances_that_are_none_are_refused(value: float) -> None:
    with pytest.raises(InvalidInputError, match='valid are numbers from 0 on, and -1 for none'):
        tolerance(value)
    with pytest.raises(JointNamesError, match="path_tolerance of 'B1'; the joints are A1, A2"):
        Tolerance.wanted([('B1', 0.1, 0.1)], NAMES, 'path_tolerance')
