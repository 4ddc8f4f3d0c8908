"""Motions that an obstacle stops: who may lead them around it, and what forbids it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from robots_controller.control.controller import Controller
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.stops.faults import Fault
from robots_controller.control.streamed_reference import StreamPoint
from robots_core.cell_interface.motion_result import BLOCKED, MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import TrajectoryRefusedError

from .two_axes import quintic, two_axes

PERIOD = 0.004
START, GOAL = np.zeros(2), np.array([1.2, -0.6])


class Rig:
    """A controller whose drives follow at once."""

    def __init__(self) -> None:
        self.controller = Controller(two_axes((20.0, 12.0)), ControllerSettings(period=PERIOD))
        self.now = 0.0
        self.step()

    @property
    def q(self) -> np.ndarray:
        reference = self.controller.reference
        return START if reference is None else reference[0].copy()

    def step(self, periods: int = 1) -> None:
        for _ in range(periods):
            self.now += PERIOD
            self.controller.step(self.now, self.q)

    def follow(self, id_: str, goal: np.ndarray = GOAL) -> None:
        self.controller.follow(FollowedMotion(quintic(self.q, goal), id_), self.now)

    def stream(self, id_: str, goal: np.ndarray) -> None:
        rest = np.zeros(2)
        self.controller.stream(StreamPoint(goal, rest, rest, self.now + 0.1), id_, self.now)

    def end(self) -> MotionResult:
        """The next result."""
        for _ in range(2000):
            if self.controller.outcomes:
                return self.controller.outcomes.popleft()
            self.step()
        raise AssertionError('the motion does not end')

    def block(self) -> MotionResult:
        """Move, and stop before an obstacle."""
        self.follow('m')
        self.step(250)
        self.controller.stop_before_collision(self.now)
        return self.end()


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_a_motion_before_an_obstacle_goes_on_under_its_id_without_a_reset(rig: Rig) -> None:
    result = rig.block()
    assert (result.ok, result.blocked, result.message) == (False, True, BLOCKED)
    assert 0.0 < float(result.details['progress']) < 1.0
    assert not rig.controller.stops.latched
    np.testing.assert_allclose(rig.q @ np.array([GOAL[1], -GOAL[0]]), 0.0, atol=1e-9)  # on its path
    rig.follow('m', np.array([0.3, 0.4]))
    assert rig.end().ok


def test_motions_that_wait_behind_it_are_blocked_with_it(rig: Rig) -> None:
    rig.follow('m')
    rig.controller.follow(FollowedMotion(quintic(GOAL, START), 'n'), rig.now)
    rig.step(100)
    rig.controller.stop_before_collision(rig.now)
    results = [rig.end(), rig.end()]
    assert [(result.id, result.blocked) for result in results] == [('m', True), ('n', True)]


def other_motion(rig: Rig) -> None:
    with pytest.raises(TrajectoryRefusedError, match='motion n would take its place'):
        rig.follow('n', START)


def stream(rig: Rig) -> None:
    with pytest.raises(TrajectoryRefusedError, match='motion s would take its place'):
        rig.stream('s', rig.q)


STOPS: dict[str, tuple[Callable[[Rig], object], str]] = {
    'a cancellation': (lambda rig: rig.controller.cancel('canceled by ~/cancel'), 'canceled by ~/cancel'),
    'a stricter fault': (lambda rig: rig.controller.trip(Fault.CONTACT, 'contact', rig.now), 'contact'),
    'a lost planner': (lambda rig: rig.controller.trip(Fault.PLANNER_LOST, 'lost', rig.now), 'lost'),
    'another commander': (
        lambda rig: rig.controller.speed.authority.take(Commander.REMOTE, standing=True),
        'the commander of the robot or its mode has changed',
    ),
    'another motion': (other_motion, 'motion n would take its place'),
    'a stream': (stream, 'motion s would take its place'),
    'no path around': (lambda rig: rig.controller.blocked.end('m', 'no free path'), 'no free path'),
}


@pytest.mark.parametrize('stop', STOPS)
def test_whatever_comes_before_the_way_around_the_robot_stays_until_a_reset(rig: Rig, stop: str) -> None:
    act, reason = STOPS[stop]
    rig.block()
    act(rig)
    with pytest.raises(TrajectoryRefusedError, match=reason):
        rig.follow('m')
    assert rig.controller.stops.latched
    with pytest.raises(TrajectoryRefusedError, match=reason):
        rig.follow('a new command')
    rig.step(10)
    rig.controller.reset()
    with pytest.raises(TrajectoryRefusedError, match=reason):  # it was planned before
        rig.follow('m')
    assert not rig.controller.stops.latched


@pytest.mark.parametrize('stop', ['a cancellation', 'another motion', 'no path around'])
def test_a_new_command_moves_the_robot_after_the_reset(rig: Rig, stop: str) -> None:
    rig.block()
    STOPS[stop][0](rig)
    state = rig.controller.stops.state
    assert state.fault is Fault.OBSTACLE
    assert state.reason.startswith(BLOCKED)
    rig.controller.reset()
    rig.follow('a new command')
    assert rig.end().ok


def test_the_end_of_another_motion_leaves_the_way_around_free(rig: Rig) -> None:
    rig.block()
    rig.controller.blocked.end('n', 'refused')
    rig.follow('m')
    assert rig.end().ok


def test_a_stream_that_an_obstacle_stops_needs_a_reset(rig: Rig) -> None:
    rig.stream('s', START + 0.01)
    rig.step(5)
    rig.controller.stop_before_collision(rig.now)
    assert rig.end().message == BLOCKED
    assert rig.controller.stops.state.fault is Fault.OBSTACLE


def test_a_person_who_stops_a_robot_that_brakes_before_an_obstacle_has_stopped_it(rig: Rig) -> None:
    rig.follow('m')
    rig.step(250)
    rig.controller.stop_before_collision(rig.now)
    rig.step(5)
    rig.controller.cancel('canceled by ~/cancel')
    rig.controller.stop_before_collision(rig.now)
    result = rig.end()
    assert (result.blocked, result.message) == (False, 'canceled by ~/cancel')
    assert rig.controller.stops.state.fault is Fault.OBSTACLE


def test_a_pause_holds_the_way_around_too(rig: Rig) -> None:
    rig.follow('m')
    rig.step(250)
    rig.controller.speed.paused = True
    rig.controller.stop_before_collision(rig.now)
    assert rig.end().blocked
    before = rig.q
    rig.follow('m')
    rig.step(100)
    np.testing.assert_array_equal(rig.q, before)
    rig.controller.speed.paused = False
    assert rig.end().ok
