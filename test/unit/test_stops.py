"""Stops by faults: category, latch, reset, and a robot that continues from where it is."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import numpy as np
import pytest

from other_threads import repeating
from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.stops.faults import Fault, StopCategory
from robots_controller.control.stops.stop_latch import StopLatch
from robots_core.errors import NotNowError, RobotsError, TrajectoryRefusedError

from .two_axes import quintic, two_axes

PERIOD = 0.004
AXES = two_axes((20.0, 12.0), jerk=(200.0, 120.0))
START, GOAL = np.zeros(2), np.array([1.2, -0.6])


class Rig:
    """A controller whose drives follow at once as long as they are on."""

    def __init__(self) -> None:
        self.controller = Controller(AXES, ControllerSettings(period=PERIOD))
        self.now = 0.0
        self.q = START
        self.references: list[np.ndarray] = []
        self.step()

    def step(self, feedback: np.ndarray | None = None, *, lost: bool = False) -> None:
        """One period with this feedback; by default where the drives are."""
        self.now += PERIOD
        seen = None if lost else self.q if feedback is None else feedback
        reference = self.controller.step(self.now, seen)
        assert reference is not None
        self.references.append(reference[0])
        if self.controller.stops.state.drives_on:
            self.q = reference[0].copy()

    def run(self, periods: int, feedback: np.ndarray | None = None, *, lost: bool = False) -> None:
        for _ in range(periods):
            self.step(feedback, lost=lost)

    def move(self) -> None:
        self.controller.follow(FollowedMotion(quintic(START, GOAL), 'm'), self.now)
        self.run(250)
        assert self.moving

    @property
    def moving(self) -> bool:
        return self.controller.state is ControllerState.FOLLOWING

    def trip(self, fault: Fault, *, stands: bool = False) -> None:
        self.controller.trip(fault, f'{fault.label}!', self.now, stands=stands)

    def run_out(self) -> int:
        """Run until the robot stands; returns the number of periods."""
        for count in range(1000):
            if self.controller.outcomes:
                return count
            self.step()
        raise AssertionError('the motion does not end')

    def check_path_and_limits(self) -> None:
        q = np.array(self.references)
        assert np.abs(q @ np.array([GOAL[1], -GOAL[0]])).max() < 1e-9
        velocity = np.diff(q, axis=0) / PERIOD
        assert (np.abs(velocity) <= AXES.velocity * (1.0 + 1e-6)).all()
        assert (np.abs(np.diff(velocity, axis=0)) / PERIOD <= AXES.acceleration * (1.0 + 1e-6)).all()


@pytest.fixture
def rig() -> Rig:
    return Rig()


@pytest.mark.parametrize('fault', [f for f in Fault if f.category > StopCategory.ZERO], ids=lambda f: f.label)
def test_a_fault_stops_on_the_path_and_holds_the_robot_until_reset(rig: Rig, fault: Fault) -> None:
    rig.move()
    rig.trip(fault)
    assert rig.controller.stops.state.drives_on
    rig.run_out()
    outcome = rig.controller.outcomes.popleft()
    assert (outcome.ok, outcome.message) == (False, f'{fault.label}!')
    rig.check_path_and_limits()
    rig.run(10)
    state = rig.controller.stops.state
    assert (state.fault, state.drives_on) == (fault, fault.category is StopCategory.TWO)
    assert rig.controller.state is ControllerState.STOPPED
    with pytest.raises(TrajectoryRefusedError, match=f'{fault.label}!; ~/reset'):
        rig.controller.follow(FollowedMotion(quintic(rig.q, START), 'n'), rig.now)
    rig.controller.reset()
    assert rig.controller.stops.state.drives_on
    rig.controller.follow(FollowedMotion(quintic(rig.q, START), 'n'), rig.now)
    rig.run_out()
    assert rig.controller.outcomes[0].ok


def test_a_stop_of_category_1_is_faster_than_one_of_category_2() -> None:
    periods = {}
    for fault in (Fault.PLANNER_LOST, Fault.EMERGENCY_STOP):
        rig = Rig()
        rig.move()
        rig.trip(fault)
        periods[fault.category] = rig.run_out()
    # 1.1 rad/s at 20 rad/s^2, against the ramp time of 0.2 s.
    assert periods[StopCategory.ONE] * PERIOD < 0.12
    assert periods[StopCategory.TWO] * PERIOD > 0.2


def test_a_stop_of_category_0_switches_the_drives_off_at_once(rig: Rig) -> None:
    rig.move()
    rig.trip(Fault.FEEDBACK_JUMPED)
    assert not rig.controller.stops.state.drives_on
    assert rig.controller.outcomes.popleft().message == 'feedback jumped!'
    coasted = rig.q + np.array([0.05, -0.02])
    rig.run(10, feedback=coasted)
    np.testing.assert_array_equal(rig.references[-1], coasted)


def test_the_first_fault_counts_until_a_stricter_one_comes(rig: Rig) -> None:
    rig.move()
    rig.trip(Fault.PLANNER_LOST)
    rig.trip(Fault.COLLISION_GUARD_LOST)
    assert rig.controller.stops.state.fault is Fault.PLANNER_LOST
    rig.trip(Fault.EMERGENCY_STOP)
    assert rig.controller.stops.state.fault is Fault.EMERGENCY_STOP
    rig.run_out()
    rig.run(2)
    rig.trip(Fault.FEEDBACK_JUMPED)
    assert rig.controller.stops.state.reason == 'emergency stop!'


def test_a_person_stops_without_a_latch(rig: Rig) -> None:
    rig.move()
    rig.controller.cancel('canceled by ~/cancel')
    rig.run_out()
    assert not rig.controller.stops.latched
    rig.controller.follow(FollowedMotion(quintic(rig.q, START), 'n'), rig.now)


def test_reset_waits_for_standstill_and_for_the_end_of_the_cause(rig: Rig) -> None:
    rig.move()
    rig.trip(Fault.COLLISION_GUARD_LOST, stands=True)
    rig.step()
    with pytest.raises(RobotsError, match='still moving'):
        rig.controller.reset()
    rig.run_out()
    with pytest.raises(RobotsError, match='cannot reset: collision guard lost!'):
        rig.controller.reset()
    rig.controller.stops.clear(Fault.COLLISION_GUARD_LOST)
    assert rig.controller.stops.latched
    rig.controller.reset()
    assert not rig.controller.stops.latched


def test_a_lost_planner_is_no_fault_of_a_robot_that_stands(rig: Rig) -> None:
    rig.trip(Fault.PLANNER_LOST)
    assert not rig.controller.stops.latched
    rig.trip(Fault.COLLISION_GUARD_LOST)
    assert rig.controller.stops.latched


def test_feedback_that_comes_back_elsewhere_moves_nothing_and_the_robot_goes_on_from_there(rig: Rig) -> None:
    rig.run(100, lost=True)
    assert rig.controller.stops.state.fault is Fault.FEEDBACK_LOST
    assert not rig.controller.stops.state.drives_on
    with pytest.raises(RobotsError, match='no feedback'):
        rig.controller.reset()
    away = START + np.array([0.6, 0.3])
    rig.q = away
    rig.run(10)
    np.testing.assert_array_equal(rig.references[-1], away)
    assert rig.controller.stops.state.fault is Fault.FEEDBACK_LOST
    rig.controller.reset()
    rig.run(50)
    np.testing.assert_array_equal(rig.references[-1], away)
    rig.controller.follow(FollowedMotion(quintic(away, GOAL), 'n'), rig.now)
    rig.run_out()
    assert rig.controller.outcomes[0].ok


def test_feedback_lost_on_the_way_ramps_down_on_the_path_and_then_brakes(rig: Rig) -> None:
    rig.move()
    rig.run(50, lost=True)
    assert rig.controller.stops.state.drives_on
    rig.run(100, lost=True)
    assert rig.controller.stops.state.fault is Fault.FEEDBACK_LOST
    assert not rig.controller.stops.state.drives_on
    rig.check_path_and_limits()


@pytest.mark.parametrize('looked_at_every', [1, 5])
def test_frozen_feedback_is_found_before_the_following_error(rig: Rig, looked_at_every: int) -> None:
    rig.move()
    frozen = rig.q.copy()
    for period in range(40):
        rig.step(frozen, lost=period % looked_at_every > 0)
    assert rig.controller.stops.state.fault is Fault.FEEDBACK_FROZEN
    assert 'A1 has not changed while its reference moved by 0.1' in rig.controller.stops.state.reason


@pytest.mark.parametrize('stands', [0.04, 0.09])
def test_feedback_that_follows_late_is_not_frozen(rig: Rig, stands: float) -> None:
    rig.run(200)
    rig.controller.follow(FollowedMotion(quintic(START, 0.1 * GOAL, duration=0.5), 'm'), rig.now)
    while np.abs(rig.references[-1]).max() < 0.02:
        rig.step(START)
    for _ in range(round(stands / PERIOD)):
        rig.step(START)
    rig.step(rig.references[-1])
    rig.run_out()
    assert rig.controller.outcomes[0].ok


def test_an_axis_that_stands_while_others_move_is_not_frozen(rig: Rig) -> None:
    rig.controller.follow(FollowedMotion(quintic(START, np.array([1.0, 0.0])), 'm'), rig.now)
    rig.run_out()
    assert rig.controller.outcomes[0].ok


def test_feedback_that_jumps_while_the_robot_stands_is_a_fault(rig: Rig) -> None:
    rig.run(500)
    rig.step(START + np.array([0.0, 0.06]))
    assert rig.controller.stops.state.fault is Fault.FEEDBACK_JUMPED
    assert 'the feedback of A2 has jumped by 0.06 rad' in rig.controller.stops.state.reason


def test_feedback_may_be_late_while_the_robot_moves(rig: Rig) -> None:
    rig.move()
    rig.run(20, lost=True)  # 80 ms without, and then 80 ms farther
    rig.run_out()
    assert rig.controller.outcomes[0].ok


def test_a_robot_that_is_pushed_away_slowly_is_a_fault(rig: Rig) -> None:
    for k in range(300):
        rig.step(np.array([0.002 * k, 0.0]))
    assert rig.controller.stops.state.fault is Fault.FOLLOWING_ERROR


def test_a_reference_that_the_guard_refuses_is_latched(rig: Rig) -> None:
    rig.controller.follow(FollowedMotion(quintic(START, GOAL, duration=0.5), 'm'), rig.now)
    rig.run_out()
    assert rig.controller.stops.state.fault is Fault.REFERENCE_REFUSED
    assert 'refused by the limit guard' in rig.controller.outcomes[0].message


def test_time_in_which_the_controller_was_held_up_loses_no_feedback(rig: Rig) -> None:
    rig.now += 2.0
    rig.step(lost=True)
    rig.run(10)
    assert not rig.controller.stops.latched


def test_the_documentation_has_the_same_table() -> None:
    text = (Path(__file__).parents[2] / 'docs' / 'reference' / 'stops.md').read_text()
    rows = re.findall(r'^\| ([a-z ]+) \| ([012]) \| (.+) \| (.+) \|$', text, re.MULTILINE)
    documented = [row for row in rows if row[0] != 'references ended']
    assert documented == [(f.label, str(f.category.value), f.reaction, f.meaning) for f in Fault]


def test_another_thread_may_ask_for_the_causes_while_they_change() -> None:
    latch = StopLatch()

    def ask() -> None:
        with contextlib.suppress(NotNowError):
            latch.check_reset()

    with repeating(ask):
        for _ in range(200):
            for fault in Fault:
                latch.trip(fault, fault.label, stands=True)
            for fault in Fault:
                latch.clear(fault)
