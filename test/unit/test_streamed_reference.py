"""Streams of single points through the controller: followed inside the limits, safe when they end."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_controller.control.controller import Controller, ControllerSettings, ControllerState
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.streamed_reference import StreamPoint
from robots_core.errors import InvalidInputError, JointLimitError, TrajectoryRefusedError
from robots_planning.trajectory import Trajectory

from .two_axes import two_axes

DT = 0.004
AXES = two_axes((4.0, 3.0))
ZERO = np.zeros(2)
# The guard's own tolerance: rounding of second differences.
WITHIN = 1.0 + 2e-6


class Rig:
    """A controller with drives that follow at once, and a sender."""

    def __init__(self) -> None:
        self.controller = Controller(AXES, ControllerSettings(period=DT))
        self.now = 0.0
        self.references: list[np.ndarray] = []
        self.step(ZERO)

    def step(self, feedback: np.ndarray | None = None) -> np.ndarray:
        self.now += DT
        last = self.controller.reference
        reference = self.controller.step(self.now, last[0].copy() if feedback is None else feedback)
        assert reference is not None
        self.references.append(reference.copy())
        return reference

    def send(
        self, q: np.ndarray, q_dot: np.ndarray = ZERO, q_ddot: np.ndarray = ZERO, ahead: float = DT
    ) -> None:
        self.controller.stream(StreamPoint(q, q_dot, q_ddot, self.now + ahead), 's', self.now)

    def check_limits(self) -> None:
        q = np.array([reference[0] for reference in self.references])
        q_dot = np.diff(q, axis=0) / DT
        assert (q >= AXES.lower - 1e-12).all()
        assert (q <= AXES.upper + 1e-12).all()
        assert (np.abs(q_dot) <= AXES.velocity * WITHIN).all()
        assert (np.abs(np.diff(q_dot, axis=0)) <= AXES.acceleration * DT * WITHIN).all()


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_a_smooth_stream_is_followed_without_lag(rig: Rig) -> None:
    for k in range(1000):
        t = rig.now + 2 * DT  # the point is due at the end of the controller's next period
        q = np.array([np.sin(t) ** 3, 0.5 * np.sin(t) ** 3])
        q_dot = 3.0 * np.sin(t) ** 2 * np.cos(t) * np.array([1.0, 0.5])
        rig.send(q, q_dot, ahead=2 * DT)
        reference = rig.step()
        if k > 10:
            # Constant acceleration over one period misses the third derivative, 6 rad/s^3 dt^3.
            np.testing.assert_allclose(reference[0], q, atol=1e-6)
    rig.check_limits()
    assert rig.controller.state is ControllerState.STREAMING


@settings(max_examples=50)
@given(
    points=st.lists(
        st.tuples(
            st.tuples(st.floats(-3.0, 3.0), st.floats(-2.0, 2.0)),
            st.tuples(st.floats(-2.0, 2.0), st.floats(-1.0, 1.0)),
            st.tuples(st.floats(-4.0, 4.0), st.floats(-3.0, 3.0)),
            st.floats(-0.2, 0.1),
            st.integers(1, 60),
        ),
        min_size=1,
        max_size=12,
    ),
    override=st.floats(0.0, 1.0),
)
def test_any_stream_stays_inside_the_limits_and_ends_at_rest(
    points: list[tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...], float, int]], override: float
) -> None:
    rig = Rig()
    for number, (q, q_dot, q_ddot, ahead, periods) in enumerate(points):
        if number == len(points) // 2:
            rig.controller.speed.set_override(override)
        rig.send(np.array(q), np.array(q_dot), np.array(q_ddot), ahead)
        for _ in range(periods):
            rig.step()
    rig.controller.speed.set_override(1.0)
    for _ in range(1000):
        rig.step()
    rig.check_limits()
    assert rig.controller.state is ControllerState.HOLDING
    assert not rig.references[-1][1:].any()


def test_a_stale_stream_brakes_and_says_so(rig: Rig) -> None:
    for k in range(100):
        rig.send(np.array([0.5 * (k + 1) * DT, 0.0]), np.array([0.5, 0.0]))
        rig.step()
    for _ in range(200):
        rig.step()
    outcome = rig.controller.outcomes.popleft()
    assert not outcome.ok
    assert outcome.id == 's'
    assert 'no streamed point for 0.1 s' in outcome.message
    rig.check_limits()
    assert not rig.references[-1][1:].any()
    # Half a second of 0.5 rad/s, 0.1 s of extrapolation, and v^2 / 2a to stop.
    assert rig.references[-1][0][0] == pytest.approx(0.2 + 0.05 + 0.03, abs=0.02)


@pytest.mark.parametrize('gap', [30, 60, 200])
def test_a_stream_that_comes_back_is_followed_at_once(rig: Rig, gap: int) -> None:
    for _ in range(100):
        rig.send(np.array([1.5, 0.5]))
        rig.step()
    for _ in range(gap):  # past the timeout: it brakes, or stands already
        rig.step()
    for _ in range(1000):
        rig.send(np.array([1.5, 0.5]))
        rig.step()
    np.testing.assert_allclose(rig.references[-1][0], [1.5, 0.5], atol=1e-9)
    rig.check_limits()


def test_a_stream_that_ends_at_rest_is_no_failure_and_a_motion_may_follow(rig: Rig) -> None:
    for _ in range(1500):
        rig.send(np.array([0.2, 0.1]))
        rig.step()
    for _ in range(40):
        rig.step()
    outcome = rig.controller.outcomes.popleft()
    assert (outcome.ok, outcome.message) == (True, 'the stream ended')
    start = rig.references[-1][0]
    np.testing.assert_allclose(start, [0.2, 0.1], atol=1e-9)
    zero = np.zeros((2, 2))
    rig.controller.follow(
        FollowedMotion(Trajectory(np.array([0.0, 2.0]), np.array([start, ZERO]), zero, zero), 'm'), rig.now
    )
    while not rig.controller.outcomes:
        rig.step()
    assert rig.controller.outcomes[0].ok
    rig.check_limits()


def test_stop_holds_until_the_sender_pauses(rig: Rig) -> None:
    for _ in range(50):
        rig.send(np.array([1.0, 0.0]))
        rig.step()
    rig.controller.cancel('canceled by ~/cancel')
    for _ in range(300):
        rig.step()
        if rig.controller.outcomes:
            break
        with pytest.raises(TrajectoryRefusedError, match='was stopped'):
            rig.send(np.array([1.0, 0.0]))
    assert rig.controller.outcomes.popleft().message == 'canceled by ~/cancel'
    for _ in range(100):
        with pytest.raises(TrajectoryRefusedError, match='was stopped'):
            rig.send(np.array([1.0, 0.0]))
        rig.step()
    for _ in range(30):
        rig.step()
    rig.send(np.array([1.0, 0.0]))
    assert rig.controller.state is ControllerState.STREAMING
    rig.check_limits()


def test_pause_holds_and_resume_goes_on(rig: Rig) -> None:
    for k in range(600):
        rig.controller.speed.paused = 100 <= k < 300
        rig.send(np.array([0.8, 0.0]))
        reference = rig.step()
        if k == 299:
            assert not reference[1].any()
            assert reference[0][0] < 0.7
    np.testing.assert_allclose(rig.references[-1][0], [0.8, 0.0], atol=1e-6)
    rig.check_limits()


def test_lost_feedback_and_a_drive_that_does_not_follow_stop_the_stream(rig: Rig) -> None:
    for _ in range(400):
        try:
            rig.send(np.array([2.0, 0.0]))
        except TrajectoryRefusedError:
            break
        rig.step(feedback=ZERO)
    assert rig.controller.outcomes or rig.controller.state is ControllerState.STREAMING
    while not rig.controller.outcomes:
        rig.step(feedback=ZERO)
    assert 'does the drive follow?' in rig.controller.outcomes[0].message


def test_a_motion_and_a_stream_exclude_each_other(rig: Rig) -> None:
    zero = np.zeros((2, 2))
    motion = Trajectory(np.array([0.0, 1.0]), np.array([ZERO, [0.3, 0.1]]), zero, zero)
    rig.send(np.array([0.1, 0.0]))
    with pytest.raises(TrajectoryRefusedError, match='still moving'):
        rig.controller.follow(FollowedMotion(motion, 'm'), rig.now)
    other = Rig()
    other.controller.follow(FollowedMotion(motion, 'm'), other.now)
    with pytest.raises(TrajectoryRefusedError, match='still moving'):
        other.send(np.array([0.1, 0.0]))


def test_points_that_break_a_limit_are_refused(rig: Rig) -> None:
    with pytest.raises(JointLimitError, match='A2'):
        rig.send(np.array([0.0, 2.1]))
    with pytest.raises(InvalidInputError, match='velocity of A1'):
        rig.send(ZERO, np.array([2.5, 0.0]))
    with pytest.raises(InvalidInputError, match='acceleration of A2'):
        rig.send(ZERO, ZERO, np.array([0.0, np.nan]))
    with pytest.raises(InvalidInputError, match='at least 2 points'):
        rig.send(ZERO, ahead=1.0)
    with pytest.raises(InvalidInputError, match=r'due 0\.6 s ago'):
        rig.send(ZERO, ahead=-0.6)
    assert rig.controller.state is ControllerState.HOLDING
