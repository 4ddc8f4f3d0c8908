"""SupervisedDrives: no step, no drives that run on, no return to an old reference."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import load_robot_model
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.drives.supervised_drives import MAX_EXTRAPOLATED, DriveState, SupervisedDrives

ROBOT = load_robot_model('kuka_kr210_r2700')
AXES = ROBOT.axes_data
HOME = np.array(ROBOT.home)
ZERO = np.zeros(AXES.num_axes)
PERIOD = 0.004
TIMEOUT = 0.2
SPEED = 0.2 * AXES.velocity


class Rig:
    """Supervised drives, and a sender of references that keep the limits."""

    def __init__(self, level: str = 'ideal') -> None:
        self.supervised = SupervisedDrives(
            drive_train(level, ROBOT, HOME, period=PERIOD), AXES, period=PERIOD, timeout=TIMEOUT
        )
        self.now = 0.0
        self.q, self.q_dot = HOME, ZERO
        self.positions: list[np.ndarray] = [HOME]

    def step(self, q: np.ndarray | None, q_dot: np.ndarray = ZERO, *, stamp: float | None = None) -> None:
        self.now += PERIOD
        position, _ = self.supervised.step(self.now, q, q_dot, stamp)
        self.positions.append(position.copy())

    def follow(self, *came: tuple[np.ndarray, np.ndarray, float] | None) -> None:
        """A period in which these references came; None is one that is not valid."""
        self.now += PERIOD
        sent = [bytes([number]) for number in range(len(came))]
        position, _ = self.supervised.follow(self.now, sent, lambda one: came[one[0]], lambda: 0.0)
        self.positions.append(position.copy())

    def run(self, periods: int, q: np.ndarray | None, q_dot: np.ndarray = ZERO) -> None:
        for _ in range(periods):
            self.step(q, q_dot)

    def speed_up(self) -> None:
        """Bring the references to a high speed inside the limits."""
        self.step(self.q)
        while (self.q_dot < SPEED).any():
            self.advance(np.minimum(self.q_dot + 0.9 * PERIOD * AXES.acceleration, SPEED))
            self.step(self.q, self.q_dot)

    def advance(self, q_dot: np.ndarray) -> None:
        self.q, self.q_dot = self.q + 0.5 * PERIOD * (self.q_dot + q_dot), q_dot

    def check_limits(self) -> None:
        velocity = np.diff(self.positions, axis=0) / PERIOD
        assert (np.abs(velocity) <= AXES.velocity * (1.0 + 1e-9)).all()
        # The last extrapolated period may end the sender's own acceleration at once.
        assert (np.abs(np.diff(velocity, axis=0)) / PERIOD <= 2.0 * AXES.acceleration).all()

    @property
    def state(self) -> DriveState:
        return self.supervised.state


@pytest.mark.parametrize('level', DRIVE_LEVELS)
def test_references_are_followed_as_by_the_drives_alone(level: str) -> None:
    rig, alone = Rig(level), drive_train(level, ROBOT, HOME, period=PERIOD)
    rig.speed_up()
    q, q_dot = HOME, ZERO
    alone.step(q, q_dot)
    while (q_dot < SPEED).any():
        faster = np.minimum(q_dot + 0.9 * PERIOD * AXES.acceleration, SPEED)
        q, q_dot = q + 0.5 * PERIOD * (q_dot + faster), faster
        alone.step(q, q_dot)
    np.testing.assert_array_equal(rig.supervised.drives.position, alone.position)
    assert rig.state is DriveState.FOLLOWING


@pytest.mark.parametrize('level', DRIVE_LEVELS)
def test_a_robot_that_stands_for_long_moves_on_as_if_each_reference_were_a_new_one(level: str) -> None:
    rig, other = Rig(level), Rig(level)
    target, still = HOME + 1e-3, np.zeros_like(HOME)

    def both(periods: int, q: np.ndarray | None, q_dot: np.ndarray = still) -> None:
        for _ in range(periods):
            rig.step(q, q_dot)
            other.step(None if q is None else q.copy(), q_dot.copy())

    both(1, HOME)
    both(2500, target)
    assert rig.supervised.standing
    both(5, target, np.full_like(HOME, 1e-3))  # the same positions with another velocity
    both(2500, target)
    both(2, None)
    both(20, target)
    rig.supervised.power(on=False)
    other.supervised.power(on=False)
    both(20, target)
    rig.supervised.power(on=True)
    other.supervised.power(on=True)
    both(200, HOME)
    both(500, None)
    assert rig.supervised.braked
    assert other.supervised.braked
    np.testing.assert_array_equal(rig.positions, other.positions)
    np.testing.assert_array_equal(rig.supervised.drives.velocity, other.supervised.drives.velocity)


@pytest.mark.parametrize('level', DRIVE_LEVELS)
def test_references_that_stand_may_be_left_out(level: str) -> None:
    rig, other = Rig(level), Rig(level)

    def both(q: np.ndarray, q_dot: np.ndarray = ZERO, *, left_out: bool = False) -> None:
        rig.step(None if left_out else q, q_dot)
        other.step(q, q_dot)

    for k in range(1000):
        both(HOME, left_out=k > 50 and k % 10 > 0)
    assert rig.state is DriveState.FOLLOWING
    assert rig.supervised.problem == ''
    # Before a motion the last one comes again, with the first of the motion.
    overtaken = [(HOME, ZERO, rig.now)]
    q, q_dot = HOME, ZERO
    while (q_dot < SPEED).any():
        faster = np.minimum(q_dot + 0.9 * PERIOD * AXES.acceleration, SPEED)
        q, q_dot = q + 0.5 * PERIOD * (q_dot + faster), faster
        rig.follow(*overtaken, (q, q_dot, rig.now + PERIOD))
        other.step(q, q_dot)
        overtaken = []
    np.testing.assert_array_equal(rig.positions, other.positions)


def test_a_jump_after_references_that_were_left_out_is_refused() -> None:
    rig = Rig('ideal')
    rig.run(10, HOME)
    rig.run(9, None)
    rig.follow((HOME, ZERO, rig.now), (HOME + PERIOD * AXES.velocity, ZERO, rig.now + PERIOD))
    assert 'its limits allow' in rig.supervised.problem
    np.testing.assert_array_equal(rig.positions[-1], HOME)


def test_the_newest_reference_that_is_valid_counts() -> None:
    rig, other = Rig(), Rig()
    for k in range(20):
        q = HOME + 1e-5 * k
        rig.follow((q - 5e-6, ZERO, rig.now), (q, ZERO, rig.now + PERIOD), *[None] * (k % 3))
        other.step(q)
    rig.follow(None)
    other.step(None)
    np.testing.assert_array_equal(rig.positions, other.positions)
    assert rig.state is other.state is DriveState.FOLLOWING


def test_references_that_stood_and_have_ended_close_the_brakes() -> None:
    rig = Rig('ideal')
    rig.run(10, HOME)
    rig.run(round(0.9 * TIMEOUT / PERIOD), None)
    assert rig.state is DriveState.FOLLOWING
    rig.run(round(0.2 * TIMEOUT / PERIOD), None)
    assert rig.state is DriveState.BRAKED
    assert rig.supervised.problem == 'the references have ended'


@pytest.mark.parametrize('level', ['ideal', 'second_order'])
def test_drives_that_have_settled_compute_nothing(level: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rig, still = Rig(level), np.zeros_like(HOME)
    rig.run(1, HOME, still)
    rig.run(2500, HOME + 1e-3, still)
    target = HOME + 2e-3
    rig.run(2500, target, still)
    monkeypatch.delattr(type(rig.supervised.drives), 'step')
    rig.run(100, target, still)
    np.testing.assert_allclose(rig.positions[-1], target, rtol=0.0, atol=1e-12)
    moving = np.array([[target, SPEED, ZERO]])
    rig.supervised.pass_over(rig.now + PERIOD, moving)
    assert not rig.supervised.standing


@pytest.mark.parametrize('level', DRIVE_LEVELS)
@pytest.mark.parametrize('how', ['the references have ended', 'switched off'])
def test_drives_ramp_down_inside_their_limits_and_brake(level: str, how: str) -> None:
    rig = Rig(level)
    assert rig.supervised.standing
    rig.speed_up()
    assert not rig.supervised.standing
    if how == 'switched off':
        rig.supervised.power(on=False)
    periods = 0
    while not rig.supervised.braked:
        rig.advance(rig.q_dot)
        rig.step(rig.q if how == 'switched off' else None, rig.q_dot)
        periods += 1
        assert periods < 500
    assert rig.supervised.standing
    if level == 'ideal':
        rig.check_limits()
    ramp = float((SPEED / AXES.acceleration).max())
    least = TIMEOUT if how != 'switched off' else 0.0
    assert periods * PERIOD <= max(ramp + MAX_EXTRAPOLATED * PERIOD, least) + 0.25
    stands = rig.positions[-1]
    rig.run(100, None)
    np.testing.assert_array_equal(rig.positions[-1], stands)
    np.testing.assert_array_equal(rig.supervised.drives.velocity, ZERO)
    assert rig.supervised.problem == (
        'switched off' if how == 'switched off' else 'the references have ended'
    )


def test_a_reference_that_the_limits_do_not_allow_is_refused_and_the_others_are_followed() -> None:
    rig = Rig()
    rig.step(HOME)
    forged = HOME + np.array([0.0, 1.5, 0.0, 0.0, 0.0, 0.0])
    for k in range(20):
        rig.step(forged if k % 3 == 1 else HOME, stamp=rig.now)
    np.testing.assert_array_equal(rig.positions[-1], HOME)
    assert rig.state is DriveState.FOLLOWING
    rig.step(forged)
    limit = f'{AXES.velocity[1]:.4g} rad/s'
    assert rig.supervised.problem == f'reference refused: A2 would move at 375 rad/s, its limit is {limit}'
    rig.step(HOME)
    rig.step(forged, stamp=0.0)
    assert rig.supervised.problem.startswith('reference refused: A2 would step by 1.5 rad, its limits allow')
    rig.step(HOME)
    assert rig.supervised.problem == ''
    rig.step(HOME, 2.0 * AXES.velocity)
    assert 'A1 would move at' in rig.supervised.problem


def test_drives_that_start_do_not_run_to_a_reference_that_stands_elsewhere() -> None:
    rig = Rig()
    rig.run(1000, HOME + 0.74)
    np.testing.assert_array_equal(rig.positions[-1], HOME)
    assert 'it is 0.74 rad from where A' in rig.supervised.problem
    rig.run(10, HOME)
    assert rig.state is DriveState.FOLLOWING


def test_braked_drives_take_up_no_reference_that_moves_past_them() -> None:
    rig = Rig()
    rig.run(10, HOME, SPEED)
    assert rig.supervised.braked
    assert 'it moves while the brakes are closed' in rig.supervised.problem


def test_a_gap_in_the_references_is_caught_up_with_inside_the_limits() -> None:
    rig = Rig()
    rig.speed_up()
    for k in range(200):
        rig.advance(np.maximum(rig.q_dot - 0.9 * PERIOD * AXES.acceleration, 0.0))
        rig.step(None if k < 20 else rig.q, rig.q_dot)
    rig.run(200, rig.q)
    assert rig.state is DriveState.FOLLOWING
    np.testing.assert_allclose(rig.positions[-1], rig.q, atol=1e-12)
    rig.check_limits()


def test_drives_that_were_held_up_do_not_step_to_the_newest_reference() -> None:
    rig = Rig()
    rig.speed_up()
    for _ in range(25):
        rig.advance(rig.q_dot)
    rig.now += 25 * PERIOD
    rig.step(rig.q, rig.q_dot)
    assert rig.state is DriveState.CATCHING_UP
    rig.check_limits()


def test_drives_that_are_switched_on_again_follow_from_where_they_stand() -> None:
    rig = Rig()
    rig.speed_up()
    rig.supervised.power(on=False)
    rig.run(300, rig.q)
    assert rig.supervised.braked
    stands = rig.positions[-1]
    rig.supervised.power(on=True)
    rig.run(10, rig.q)
    np.testing.assert_array_equal(rig.positions[-1], stands)
    rig.run(10, stands)
    assert rig.state is DriveState.FOLLOWING
