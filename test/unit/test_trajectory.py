"""Trajectory: the quintic between points, and what it refuses."""

import numpy as np
import pytest

from robots_core.errors import InvalidInputError
from robots_planning import Trajectory


@pytest.fixture
def cubic() -> Trajectory:
    """Points of q = (t^3, 2 - t), which the quintic must reproduce between them."""
    t = np.array([0.0, 0.3, 1.0])
    one, zero = np.ones_like(t), np.zeros_like(t)
    return Trajectory(
        t,
        np.stack([t**3, 2.0 - t], axis=1),
        np.stack([3.0 * t**2, -one], axis=1),
        np.stack([6.0 * t, zero], axis=1),
    )


def test_cubic_is_reproduced_between_points(cubic: Trajectory) -> None:
    t = np.linspace(0.0, 1.0, 57)
    q, q_dot, q_ddot = cubic.sample(t)
    # Rounding of the coefficients, multiplied by 1 / h^2 of the shortest interval in the acceleration.
    np.testing.assert_allclose(q, np.stack([t**3, 2.0 - t], axis=1), atol=1e-14)
    np.testing.assert_allclose(q_dot[:, 0], 3.0 * t**2, atol=1e-13)
    np.testing.assert_allclose(q_ddot[:, 0], 6.0 * t, atol=1e-12)


def test_outside_its_time_it_rests_at_the_ends(cubic: Trajectory) -> None:
    q, q_dot, q_ddot = cubic.sample([-1.0, 2.0])
    # The end is the last polynomial at its end: rounding of six terms.
    np.testing.assert_allclose(q, [[0.0, 2.0], [1.0, 1.0]], atol=1e-14)
    np.testing.assert_array_equal(q_dot, np.zeros((2, 2)))
    np.testing.assert_array_equal(q_ddot, np.zeros((2, 2)))


def test_scalar_and_grid_of_times_keep_their_shape(cubic: Trajectory) -> None:
    assert cubic.sample(0.5)[0].shape == (2,)
    assert cubic.sample(np.full((3, 4), 0.5))[1].shape == (3, 4, 2)


def test_arrays_are_read_only(cubic: Trajectory) -> None:
    with pytest.raises(ValueError, match='read-only'):
        cubic.position[0, 0] = 1.0


def test_acceleration_extremes_bound_every_sample() -> None:
    rng = np.random.default_rng(3)
    t = np.cumsum(rng.uniform(0.05, 0.4, 12)) - 0.0
    t = t - t[0]
    trajectory = Trajectory(t, *(rng.normal(size=(12, 3)) for _ in range(3)))
    _, acceleration, jerk = trajectory.acceleration_extremes()
    q_ddot = np.abs(trajectory.sample(np.linspace(0.0, trajectory.duration, 200001))[2])
    # The samples are 1e-5 s apart: they come this close to an extreme, and never pass it.
    assert (q_ddot.max(axis=0) <= acceleration.max(axis=0) * (1.0 + 1e-12)).all()
    np.testing.assert_allclose(q_ddot.max(axis=0), acceleration.max(axis=0), rtol=1e-3)
    assert (np.abs(np.diff(q_ddot, axis=0)).max(axis=0) <= jerk.max(axis=0) * 2e-5).all()


@pytest.mark.parametrize(
    ('time', 'message'),
    [
        ([0.0], 'at least 2'),
        ([0.1, 0.2], 'start at 0'),
        ([0.0, 0.0], 'increase'),
        ([0.0, np.nan], 'not finite'),
    ],
)
def test_bad_times_are_refused(time: list[float], message: str) -> None:
    values = np.zeros((len(time), 2))
    with pytest.raises(InvalidInputError, match=message):
        Trajectory(np.array(time), values, values, values)


def test_shapes_that_differ_are_refused() -> None:
    zero = np.zeros((2, 2))
    with pytest.raises(InvalidInputError, match=r'must all be \(2, n\)'):
        Trajectory(np.array([0.0, 1.0]), zero, np.zeros((2, 3)), zero)


def test_message_times_are_whole_nanoseconds() -> None:
    time = Trajectory.message_times(np.array([0.0, 1.0 / 3.0, 2.0 / 7.0]))
    nanoseconds = np.array([0, 333333333, 285714286])
    np.testing.assert_array_equal(np.round(time * 1e9), nanoseconds)
    # What a reader of the message computes is the planned time to the last digits of a double.
    np.testing.assert_allclose(time, 1e-9 * nanoseconds, rtol=1e-15)
