"""ReparametrisedPath: the same path over a coordinate of about constant joint speed."""

from __future__ import annotations

import numpy as np
import pytest

from robots_planning.paths.joint_path import JointPath
from robots_planning.paths.reparametrised_path import ReparametrisedPath
from robots_planning.timing.tool_limits import LimitedRates

VELOCITY, ACCELERATION = np.array([2.0, 3.0]), np.array([10.0, 8.0])
STEP = 1e-6


def turning_path(closeness: float) -> JointPath:
    """One axis moves on while the other turns half round within a part `closeness` of the path."""
    side = 0.5 * np.geomspace(0.05 * closeness, 1.0, 200)
    s = np.concatenate([0.5 - side[::-1], [0.5], 0.5 + side])
    x = (s - 0.5) / closeness
    q = np.column_stack([s, np.arctan(x)])
    q_s = np.column_stack([np.ones_like(s), 1.0 / (closeness * (1.0 + x**2))])
    q_ss = np.column_stack([np.zeros_like(s), -2.0 * x / (closeness**2 * (1.0 + x**2) ** 2)])
    s[0], s[-1] = 0.0, 1.0
    return JointPath(s, q, q_s, q_ss)


@pytest.fixture(params=[1.0, 1e-2, 1e-6])
def path(request: pytest.FixtureRequest) -> JointPath:
    return turning_path(request.param)


def even(path: JointPath) -> ReparametrisedPath:
    return ReparametrisedPath(path, VELOCITY, ACCELERATION)


def test_it_runs_from_end_to_end_without_turning_back(path: JointPath) -> None:
    s, slope, _ = even(path).s_of(np.linspace(0.0, 1.0, 5001))
    assert s[0] == 0.0
    assert s[-1] == 1.0
    assert (slope > 0.0).all()
    np.testing.assert_array_equal(even(path).evaluate(np.array([0.0, 1.0]))[0], path.q[[0, -1]])


def test_derivatives_are_those_of_the_positions(path: JointPath) -> None:
    sigma = np.linspace(0.01, 0.99, 501)
    _, first, second = even(path).evaluate(sigma)
    (before, slow, _), (after, fast, _) = (even(path).evaluate(sigma + side) for side in (-STEP, STEP))
    # Central differences: some 1e7 times the square of the step, and rounding over it.
    np.testing.assert_allclose((after - before) / (2.0 * STEP), first, atol=1e-4)
    np.testing.assert_allclose((fast - slow) / (2.0 * STEP), second, rtol=1e-3, atol=1e-2)


def test_axes_move_evenly_however_fast_they_turn_over_s(path: JointPath) -> None:
    rate = np.linalg.norm(even(path).evaluate(np.linspace(0.0, 1.0, 5001))[1] / VELOCITY, axis=1)
    length = np.linalg.norm(np.diff(path.q / VELOCITY, axis=0), axis=1).sum()
    # With sqrt(1 + (rate / mean)^2) the rate is at most 1 + 1 times its mean.
    assert rate.max() <= 2.0 * length * (1.0 + 1e-3)


def test_derivatives_of_others_follow(path: JointPath) -> None:
    sigma = np.linspace(0.0, 1.0, 101)
    _, first, second = even(path).evaluate(sigma)
    s, *slopes = even(path).s_of(sigma)
    q, q_s, q_ss = path.evaluate(s)
    given = LimitedRates(q_s, q_ss, 0.0 * q, VELOCITY, ACCELERATION).over(*slopes)
    np.testing.assert_array_equal([given.rate, given.along], [first, second])


def test_the_grid_increases_and_is_finer_where_the_direction_turns() -> None:
    sizes = []
    for closeness in (1.0, 1e-6):
        grid = even(turning_path(closeness)).grid
        assert (np.diff(grid) > 0.0).all()
        assert (grid[0], grid[-1]) == (0.0, 1.0)
        sizes.append(len(grid))
    assert sizes[1] > sizes[0]


def test_seams_are_found_again(path: JointPath) -> None:
    seams = path.s[[40, 150]]
    with_seams = JointPath(path.s, path.q, path.q_s, path.q_ss, seams)
    np.testing.assert_allclose(even(path).s_of(even(with_seams).seams)[0], seams, rtol=1e-12)


def test_a_path_that_stands_still_has_a_grid_too() -> None:
    still = np.zeros((2, 2))
    path = JointPath(np.array([0.0, 1.0]), still, still, still)
    assert np.isfinite(even(path).grid).all()
