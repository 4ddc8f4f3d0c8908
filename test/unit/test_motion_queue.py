"""Motions that are sent while another one runs: one after the other, or in its place."""

from __future__ import annotations

import numpy as np
import pytest

from other_threads import repeating
from robots_controller.control.controller import Controller, ControllerSettings, ControllerState
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.motion_queue import LONGEST_QUEUE
from robots_core.errors import TrajectoryRefusedError
from robots_planning.trajectory import Trajectory

from .two_axes import two_axes

PERIOD = 0.01
AXES = two_axes((2.0, 1.2))
START, CORNER, END = np.zeros(2), np.array([0.5, 0.2]), np.array([0.1, 0.6])


def move(start: np.ndarray, goal: np.ndarray, duration: float = 2.0) -> Trajectory:
    """Minimum-jerk motion in ten pieces."""
    x = np.linspace(0.0, 1.0, 11)[:, None]
    way = goal - start
    return Trajectory(
        duration * x[:, 0],
        start + way * (10 * x**3 - 15 * x**4 + 6 * x**5),
        way * (30 * x**2 - 60 * x**3 + 30 * x**4) / duration,
        way * (60 * x - 180 * x**2 + 120 * x**3) / duration**2,
    )


def rest_of(trajectory: Trajectory, index: int) -> Trajectory:
    """The trajectory from one of its points on."""
    return Trajectory(
        trajectory.time[index:] - trajectory.time[index],
        trajectory.position[index:],
        trajectory.velocity[index:],
        trajectory.acceleration[index:],
    )


@pytest.fixture
def controller() -> Controller:
    controller = Controller(AXES, ControllerSettings(period=PERIOD))
    controller.step(0.0, START)
    return controller


class Run:
    """Steps a controller whose robot follows at once."""

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.now = 0.0
        self.references: list[np.ndarray] = []

    def steps(self, count: int) -> None:
        for _ in range(count):
            self.now += PERIOD
            assert self.controller.reference is not None
            reference = self.controller.step(self.now, self.controller.reference[0])
            assert reference is not None
            self.references.append(reference)

    def until_holding(self) -> np.ndarray:
        while not self.references or self.controller.state is not ControllerState.HOLDING:
            assert len(self.references) < 3000
            self.steps(1)
        return np.array(self.references)


def test_queued_motions_follow_each_other_and_pass_every_target_exactly(controller: Controller) -> None:
    run = Run(controller)
    targets = [CORNER, END, START]
    begin = START
    for number, target in enumerate(targets):
        controller.follow(FollowedMotion(move(begin, target), str(number)), 0.0)
        begin = target
    positions = run.until_holding()[:, 0]
    assert [(outcome.id, outcome.ok) for outcome in controller.outcomes] == [
        ('0', True),
        ('1', True),
        ('2', True),
    ]
    for target in targets:
        assert np.abs(positions - target).max(axis=1).min() <= 1e-12
    # Between two motions the reference stands for as long as the moving average needs, and no longer.
    window = round(controller.settings.smoothing_time / PERIOD)
    standing = (np.abs(positions - CORNER).max(axis=1) == 0.0).sum()
    assert standing <= window + 3


def test_a_motion_that_waits_must_start_at_the_end_of_the_one_before(controller: Controller) -> None:
    controller.follow(FollowedMotion(move(START, CORNER), 'a'), 0.0)
    with pytest.raises(TrajectoryRefusedError, match=r'starts -0.5 rad from where A1 ends with the motion'):
        controller.follow(FollowedMotion(move(START, END), 'b'), 0.0)


def test_a_motion_that_starts_with_a_velocity_needs_one_to_join(controller: Controller) -> None:
    moving = rest_of(move(START, CORNER), 4)
    with pytest.raises(TrajectoryRefusedError, match='starts with a velocity, but the robot will stand'):
        controller.follow(FollowedMotion(moving, 'a'), PERIOD)
    with pytest.raises(TrajectoryRefusedError, match='but it stands: it came too late'):
        controller.follow(FollowedMotion(moving, 'a'), PERIOD, join_time=0.5)


def test_a_motion_must_go_on_from_the_running_one(controller: Controller) -> None:
    controller.follow(FollowedMotion(move(START, CORNER), 'a'), 0.0)
    with pytest.raises(TrajectoryRefusedError, match=r'does not go on from the running motion at 0\.900 s'):
        controller.follow(FollowedMotion(rest_of(move(START, CORNER), 5), 'b'), 0.0, join_time=0.9)


@pytest.mark.parametrize('override', [1.0, 0.4])
def test_a_motion_that_joins_the_running_one_leaves_no_trace(override: float) -> None:
    whole = move(START, CORNER)
    runs = []
    for joined in (False, True):
        controller = Controller(AXES, ControllerSettings(period=PERIOD))
        controller.step(0.0, START)
        controller.speed.set_override(override)
        controller.follow(FollowedMotion(whole, 'a'), 0.0)
        run = Run(controller)
        run.steps(10)
        if joined:
            controller.follow(FollowedMotion(rest_of(whole, 5), 'b'), run.now, join_time=float(whole.time[5]))
        run.steps(40)
        controller.speed.set_override(1.0)  # the path speed changes across the joint as on one path
        runs.append(run.until_holding())
    plain, led_on = runs
    # The controller works in doubles on polynomials that are the same except for their time scale.
    np.testing.assert_allclose(led_on[: len(plain)], plain[: len(led_on)], atol=1e-9)
    outcomes = list(controller.outcomes)
    assert [(outcome.id, outcome.ok) for outcome in outcomes] == [('a', False), ('b', True)]
    assert outcomes[0].message == 'replaced by motion b'


@pytest.mark.parametrize('override', [1.0, 0.4])
def test_motions_that_carry_each_other_on_are_one_motion_of_several_results(override: float) -> None:
    whole = move(START, CORNER)
    middle, last = rest_of(whole, 4), rest_of(whole, 7)
    runs = []
    for carried in (False, True):
        controller = Controller(AXES, ControllerSettings(period=PERIOD))
        controller.step(0.0, START)
        controller.speed.set_override(override)
        controller.follow(FollowedMotion(whole, 'a'), 0.0)
        run = Run(controller)
        run.steps(5)
        if carried:  # both come while the first is followed
            controller.follow(FollowedMotion(middle, 'b'), run.now, join_time=-middle.duration)
            controller.follow(FollowedMotion(last, 'c'), run.now, join_time=-last.duration)
        runs.append(run.until_holding())
    plain, continued_from = runs
    # The controller works in doubles on polynomials that are the same except for their time scale.
    np.testing.assert_allclose(continued_from, plain, atol=1e-9)
    assert [(outcome.id, outcome.ok, outcome.message) for outcome in controller.outcomes] == [
        ('a', True, 'passed'),
        ('b', True, 'passed'),
        ('c', True, 'reached'),
    ]
    planned = [outcome.details['planned_duration'] for outcome in controller.outcomes]
    assert planned == pytest.approx([whole.time[4], whole.time[7] - whole.time[4], last.duration], abs=1e-6)


def test_a_motion_may_carry_on_one_that_still_waits(controller: Controller) -> None:
    controller.follow(FollowedMotion(move(START, CORNER), 'a'), 0.0)
    second = move(CORNER, END)
    controller.follow(FollowedMotion(second, 'b'), 0.0)
    rest = rest_of(second, 5)
    controller.follow(FollowedMotion(rest, 'c'), 0.0, join_time=-rest.duration)
    positions = Run(controller).until_holding()[:, 0]
    np.testing.assert_allclose(positions[-1], END, atol=1e-12)
    assert [(outcome.id, outcome.message) for outcome in controller.outcomes] == [
        ('a', 'reached'),
        ('b', 'passed'),
        ('c', 'reached'),
    ]


def test_a_motion_that_nothing_carries_on_in_time_ends_where_it_was_planned_to(
    controller: Controller,
) -> None:
    whole = move(START, CORNER)
    controller.follow(FollowedMotion(whole, 'a'), 0.0)
    run = Run(controller)
    run.steps(120)
    rest = rest_of(whole, 5)
    with pytest.raises(TrajectoryRefusedError, match='came too late'):
        controller.follow(FollowedMotion(rest, 'b'), run.now, join_time=-rest.duration)
    np.testing.assert_allclose(run.until_holding()[-1, 0], CORNER, atol=1e-12)


@pytest.mark.parametrize('steps', [50, 95, 105])
def test_a_stop_around_the_place_where_a_motion_is_carried_on_stays_on_the_path_and_inside_the_limits(
    controller: Controller, steps: int
) -> None:
    whole = move(START, CORNER)
    rest = rest_of(whole, 5)
    controller.follow(FollowedMotion(whole, 'a'), 0.0)
    controller.follow(FollowedMotion(rest, 'b'), 0.0, join_time=-rest.duration)
    run = Run(controller)
    run.steps(steps)
    controller.cancel('canceled by a person')
    references = run.until_holding()
    assert controller.outcomes[-1].message.endswith('canceled by a person')
    assert [outcome.ok for outcome in controller.outcomes][-1] is False
    q = references[:, 0]
    way = (CORNER - START) / np.linalg.norm(CORNER - START)
    assert np.abs(q - np.outer(q @ way, way)).max() < 1e-12
    # Limits as the guard takes them.
    assert (np.abs(np.diff(q, 2, axis=0)) / PERIOD**2 <= AXES.acceleration * (1.0 + 1e-6)).all()


def test_a_motion_that_comes_too_late_to_join_is_refused(controller: Controller) -> None:
    whole = move(START, CORNER)
    controller.follow(FollowedMotion(whole, 'a'), 0.0)
    run = Run(controller)
    run.steps(100)
    with pytest.raises(TrajectoryRefusedError, match='came too late'):
        controller.follow(FollowedMotion(rest_of(whole, 5), 'b'), run.now, join_time=float(whole.time[5]))
    run.until_holding()
    assert [(outcome.id, outcome.ok) for outcome in controller.outcomes] == [('a', True)]


def test_a_stop_gives_up_what_waits(controller: Controller) -> None:
    run = Run(controller)
    controller.follow(FollowedMotion(move(START, CORNER), 'a'), 0.0)
    controller.follow(FollowedMotion(move(CORNER, END), 'b'), 0.0)
    run.steps(30)
    controller.cancel('canceled by a person')
    with pytest.raises(TrajectoryRefusedError, match='still moving'):
        controller.follow(FollowedMotion(move(END, START), 'c'), run.now)
    run.until_holding()
    assert [(outcome.id, outcome.ok, outcome.message) for outcome in controller.outcomes] == [
        ('a', False, 'canceled by a person'),
        ('b', False, 'given up with the motion before it: canceled by a person'),
    ]


def test_the_queue_is_bounded(controller: Controller) -> None:
    controller.follow(FollowedMotion(move(START, CORNER), 'first'), 0.0)
    ends = [CORNER, END]
    for number in range(LONGEST_QUEUE):
        controller.follow(FollowedMotion(move(ends[number % 2], ends[(number + 1) % 2]), str(number)), 0.0)
    with pytest.raises(TrajectoryRefusedError, match=f'{LONGEST_QUEUE} motions are waiting'):
        controller.follow(FollowedMotion(move(CORNER, END), 'last'), 0.0)


def test_another_thread_may_look_at_the_motions_as_they_end(controller: Controller) -> None:
    run = Run(controller)
    near = 0.004 * CORNER

    def check() -> None:
        assert None not in controller.motions
        assert controller.state in ControllerState

    with repeating(check):
        for begin, end in [(START, near), (near, START)] * 100:
            controller.follow(FollowedMotion(move(begin, end, duration=0.2), 'seen'), run.now)
            run.until_holding()
            run.references.clear()
