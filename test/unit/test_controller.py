"""The controller's answers to what should not happen, one by one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from robots_controller.control.controller import Controller, ControllerSettings, ControllerState
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.stops.faults import Fault
from robots_core.errors import InvalidInputError, TrajectoryRefusedError
from robots_planning.trajectory import Trajectory

from .two_axes import quintic, two_axes

AXES = two_axes((2.0, 1.2))


@pytest.fixture
def controller() -> Controller:
    controller = Controller(AXES, ControllerSettings(period=0.01))
    controller.step(0.0, np.zeros(2))
    return controller


def run_until_outcome(
    controller: Controller, now: float, follow: Callable[[np.ndarray], np.ndarray] = np.copy
) -> float:
    """Step with feedback that follows at once, or as it is given."""
    for _ in range(2000):
        now += 0.01
        reference = controller.reference
        assert reference is not None
        controller.step(now, follow(reference[0]))
        if controller.outcomes:
            return now
    raise AssertionError('no outcome')


def test_waits_for_feedback_before_it_sends_anything() -> None:
    controller = Controller(AXES)
    assert controller.step(0.0, None) is None
    assert controller.state is ControllerState.WAITING
    with pytest.raises(TrajectoryRefusedError, match='no feedback'):
        controller.follow(FollowedMotion(quintic(np.zeros(2), np.ones(2)), 'x'), 0.0)


def test_takes_the_first_feedback_ahead() -> None:
    controller = Controller(AXES)
    controller.take(0.0, np.array([0.4, -0.3]))
    reference = controller.step(0.004, None)
    assert reference is not None
    np.testing.assert_array_equal(reference, [[0.4, -0.3], [0, 0], [0, 0]])


def test_acts_in_the_next_period_on_feedback_that_was_taken_ahead(controller: Controller) -> None:
    controller.follow(FollowedMotion(quintic(np.zeros(2), np.array([0.5, 0.2])), 'x'), 0.0)
    for now in np.arange(0.01, 0.5, 0.01):
        reference = controller.step(now, None)
        assert reference is not None
        controller.take(now, reference[0])
    controller.take(now, reference[0] + np.array([0.0, 0.5]))
    assert controller.stops.state.fault is None
    controller.step(now + 0.01, None)
    assert controller.stops.state.fault is Fault.FEEDBACK_JUMPED


def test_stands_where_the_robot_stands() -> None:
    controller = Controller(AXES)
    reference = controller.step(0.0, np.array([0.4, -0.3]))
    assert reference is not None
    np.testing.assert_array_equal(reference, [[0.4, -0.3], [0, 0], [0, 0]])


def test_reports_the_end_with_planned_and_real_duration(controller: Controller) -> None:
    controller.follow(FollowedMotion(quintic(np.zeros(2), np.array([0.5, 0.2])), 'x'), 0.0)
    run_until_outcome(controller, 0.0)
    outcome = controller.outcomes[0]
    assert (outcome.id, outcome.ok, outcome.message) == ('x', True, 'reached')
    assert outcome.details['planned_duration'] == 2.0
    # Two seconds of path and the moving average's 20 ms, plus the periods in which the end is noticed.
    assert 2.0 <= float(outcome.details['duration']) <= 2.06


def test_refuses_a_trajectory_that_starts_elsewhere(controller: Controller) -> None:
    with pytest.raises(TrajectoryRefusedError, match=r'starts \+0\.1 rad from where A2 stands'):
        controller.follow(FollowedMotion(quintic(np.array([0.0, 0.1]), np.ones(2)), 'x'), 0.0)


def test_refuses_another_number_of_axes(controller: Controller) -> None:
    zero = np.zeros((2, 3))
    with pytest.raises(TrajectoryRefusedError, match='has 3 axes, the robot has 2'):
        controller.follow(FollowedMotion(Trajectory(np.array([0.0, 1.0]), zero, zero, zero), 'x'), 0.0)


def test_the_scaling_of_the_drives_counts_besides_the_override(controller: Controller) -> None:
    speed = controller.speed
    speed.set_override(0.5)
    speed.set_scaling(0.4)
    assert speed._target(enabled=True) == pytest.approx(0.2)
    with pytest.raises(InvalidInputError, match=r'speed_scaling .* must be in \[0, 1\]'):
        speed.set_scaling(1.5)
    assert speed.scaling == 0.4


@pytest.mark.parametrize('value', [-0.1, 1.1, float('nan'), float('inf')])
def test_refuses_an_override_outside_its_range(controller: Controller, value: float) -> None:
    with pytest.raises(InvalidInputError, match=r'override .* must be in \[0, 1\]'):
        controller.speed.set_override(value)
    assert controller.speed.override == 1.0


def test_says_which_axis_does_not_reach_its_target(controller: Controller) -> None:
    goal = np.array([0.3, 0.2])
    controller.follow(FollowedMotion(quintic(np.zeros(2), goal), 'x'), 0.0)
    run_until_outcome(controller, 0.0, lambda q: q + np.array([0.0, 1e-3]))
    outcome = controller.outcomes[0]
    assert not outcome.ok
    assert outcome.message.startswith('A2 stands 0.001 rad from its target')


def test_says_which_axis_does_not_follow(controller: Controller) -> None:
    controller.follow(FollowedMotion(quintic(np.zeros(2), np.array([1.0, 0.0])), 'x'), 0.0)
    run_until_outcome(controller, 0.0, lambda q: 0.3 * q)
    outcome = controller.outcomes[0]
    assert not outcome.ok
    assert outcome.message.startswith('A1 is 0.5')


def test_takes_the_next_trajectory_after_feedback_was_lost_and_came_back(controller: Controller) -> None:
    controller.follow(FollowedMotion(quintic(np.zeros(2), np.array([0.5, 0.2])), 'x'), 0.0)
    now = 0.0
    while not controller.outcomes:
        now += 0.01
        controller.step(now, None)
    assert 'no feedback for 0.2 s' in controller.outcomes.popleft().message
    reference = controller.reference
    assert reference is not None
    controller.step(now + 0.01, reference[0])
    controller.reset()
    controller.follow(FollowedMotion(quintic(reference[0], np.zeros(2)), 'y'), now)
    run_until_outcome(controller, now)
    assert controller.outcomes[0].ok


@pytest.mark.parametrize('name', ['period', 'ramp_time', 'feedback_timeout', 'goal_tolerance'])
@pytest.mark.parametrize('value', [0.0, -1.0, float('nan')])
def test_settings_must_be_positive(name: str, value: float) -> None:
    with pytest.raises(InvalidInputError, match=name):
        ControllerSettings(**{name: value})
