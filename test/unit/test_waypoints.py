"""Trajectories of others become motions that pass their points."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core.errors import InvalidInputError
from robots_planning.waypoints import trajectory_through

START = np.array([0.1, -0.2])
TIME = np.array([0.5, 1.2, 2.0])
POSITION = np.array([[0.3, 0.0], [0.6, 0.5], [0.4, 0.4]])
VELOCITY = np.array([[0.4, 0.3], [0.2, 0.1], [0.0, 0.0]])
ACCELERATION = np.array([[0.1, 0.2], [-0.3, 0.1], [0.0, 0.0]])


@pytest.mark.parametrize('given', [(None, None), (VELOCITY, None), (VELOCITY, ACCELERATION)])
def test_passes_what_is_given_and_rests_at_both_ends(given: tuple[np.ndarray | None, ...]) -> None:
    trajectory = trajectory_through(TIME, (POSITION, *given), START)
    states = trajectory.sample(TIME)
    np.testing.assert_allclose(states[0], POSITION, atol=1e-12)
    for state, wanted in zip(states[1:], given, strict=True):
        if wanted is not None:
            np.testing.assert_allclose(state, wanted, atol=1e-12)
    np.testing.assert_array_equal(trajectory.position[0], START)
    for row in (0, -1):
        assert not trajectory.velocity[row].any()
        assert not trajectory.acceleration[row].any() or given[1] is not None or row == -1


def test_positions_alone_have_continuous_acceleration_between_the_ends() -> None:
    trajectory = trajectory_through(TIME, (POSITION, None, None), START)
    before, after = (trajectory.sample(TIME[:-1] + shift)[2] for shift in (-1e-9, 1e-9))
    np.testing.assert_allclose(before, after, atol=1e-5)  # 2 ns of the jerk in between


def test_a_first_point_at_time_zero_is_the_start() -> None:
    time = np.array([0.0, 1.0])
    trajectory = trajectory_through(time, (np.array([START + 1e-3, [0.4, 0.4]]), None, None), START)
    np.testing.assert_array_equal(trajectory.position[0], START)
    with pytest.raises(InvalidInputError, match=r'starts \+0\.2 from where axis 1 stands'):
        trajectory_through(time, (np.array([[0.3, -0.2], [0.4, 0.4]]), None, None), START)


@pytest.mark.parametrize(
    ('time', 'position', 'velocity', 'acceleration', 'reason'),
    [
        (TIME[:0], POSITION[:0], None, None, 'at least one point'),
        (TIME[::-1], POSITION, None, None, 'increase'),
        (-TIME[::-1], POSITION, None, None, '0 or above'),
        (TIME, POSITION, None, ACCELERATION, 'accelerations need velocities'),
        (np.zeros(1), START[None], None, None, 'no motion'),
    ],
)
def test_points_that_make_no_motion_are_refused(
    time: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray | None,
    acceleration: np.ndarray | None,
    reason: str,
) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        trajectory_through(time, (position, velocity, acceleration), START)


@pytest.mark.parametrize('late', [0.0, 0.7, 1.2])
def test_what_is_late_goes_through_the_points_that_are_left(late: float) -> None:
    ahead = late < TIME
    rows = POSITION, VELOCITY, ACCELERATION
    trajectory = trajectory_through(TIME, rows, START, late=late)
    left = trajectory_through(TIME[ahead] - late, [row[ahead] for row in rows], START)
    for name in ('time', 'position', 'velocity', 'acceleration'):
        np.testing.assert_array_equal(getattr(trajectory, name), getattr(left, name))


def test_velocities_alone_lead_to_the_positions_that_they_integrate_to() -> None:
    trajectory = trajectory_through(TIME, (None, VELOCITY, None), START)
    _, q_dot, _ = trajectory.sample(TIME)
    np.testing.assert_allclose(q_dot, VELOCITY, atol=1e-12)
    v = np.array([[0.0, 0.0], *VELOCITY])
    way = 0.5 * np.diff(TIME, prepend=0.0) @ (v[1:] + v[:-1])
    np.testing.assert_allclose(trajectory.position[-1], START + way, atol=1e-12)


@pytest.mark.parametrize(
    ('time', 'rows', 'late', 'complaint'),
    [
        (TIME[:0], (None, None, None), 0.0, 'a trajectory needs at least one point, got 0'),
        (TIME, (POSITION, None, None), 3.0, 'the trajectory has ended 1 s ago'),
        (TIME, (None, None, ACCELERATION), 0.0, 'points have neither positions nor velocities'),
    ],
)
def test_points_of_clients_that_make_no_motion_are_refused(
    time: np.ndarray, rows: tuple[np.ndarray | None, ...], late: float, complaint: str
) -> None:
    with pytest.raises(InvalidInputError, match=complaint):
        trajectory_through(time, rows, START, late=late)
