"""Motions that an obstacle stops: who may lead them around it, and what forbids it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from robots_controller.control.controller import Controller
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.stops.faults import Fault
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import TrajectoryRefusedError
from robots_planning.commands.motion_results import BLOCKED

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
        self.controller.follow(quintic(self.q, goal), id_, self.now)

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
        self.controller.stop_before_collision()
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
    rig.controller.follow(quintic(GOAL, START), 'n', rig.now)
    rig.step(100)
    rig.controller.stop_before_collision()
    results = [rig.end(), rig.end()]
    assert [(result.id, result.blocked) for result in results] == [('m', True), ('n', True)]


def trip_and_reset(rig: Rig) -> None:
    rig.controller.trip(Fault.EMERGENCY_STOP, 'e-stop', rig.now)
    rig.step(5)
    rig.controller.reset()


def other_motion(rig: Rig) -> None:
    rig.follow('n', START)
    assert rig.end().ok


STOPS = {
    'a person': (lambda rig: rig.controller.cancel('canceled by ~/cancel'), 'canceled by ~/cancel'),
    'a fault, reset since': (trip_and_reset, 'e-stop'),
    'another commander': (
        lambda rig: rig.controller.speed.authority.take(Commander.REMOTE, standing=True),
        'the commander of the robot or its mode has changed',
    ),
    'another motion': (other_motion, 'motion n has taken its place'),
}


@pytest.mark.parametrize('stop', STOPS)
def test_nothing_moves_the_robot_that_somebody_has_stopped_meanwhile(rig: Rig, stop: str) -> None:
    act: Callable[[Rig], None]
    act, reason = STOPS[stop]
    rig.block()
    act(rig)
    with pytest.raises(TrajectoryRefusedError, match=reason):
        rig.follow('m')
    rig.step(10)
    rig.follow('a new command')  # nothing is latched
    assert rig.end().ok


def test_a_person_who_stops_a_robot_that_brakes_before_an_obstacle_has_stopped_it(rig: Rig) -> None:
    rig.follow('m')
    rig.step(250)
    rig.controller.stop_before_collision()
    rig.step(5)
    rig.controller.cancel('canceled by ~/cancel')
    rig.controller.stop_before_collision()
    result = rig.end()
    assert (result.blocked, result.message) == (False, 'canceled by ~/cancel')


def test_a_pause_holds_the_way_around_too(rig: Rig) -> None:
    rig.follow('m')
    rig.step(250)
    rig.controller.speed.paused = True
    rig.controller.stop_before_collision()
    assert rig.end().blocked
    before = rig.q
    rig.follow('m')
    rig.step(100)
    np.testing.assert_array_equal(rig.q, before)
    rig.controller.speed.paused = False
    assert rig.end().ok
