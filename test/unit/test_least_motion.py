"""The compiled pseudo-inverse next to NumPy's, in and around singular postures."""

import numpy as np
import pytest

from robots_planning.trajectory_generators.least_motion import SINGULAR, least_motion, pseudo_inverse


def with_singular_values(rng: np.random.Generator, n: int, values: np.ndarray) -> np.ndarray:
    size = min(6, n)
    U = np.linalg.qr(rng.normal(size=(6, size)))[0]
    V = np.linalg.qr(rng.normal(size=(n, size)))[0]
    return np.ascontiguousarray(U * values @ V.T)


@pytest.mark.parametrize('n', [1, 3, 5, 6, 7, 9])
@pytest.mark.parametrize('smallest', [1.0, 1e-3, 1e-6, 1e-8, 1e-11, 0.0])
def test_is_the_pseudo_inverse(n: int, smallest: float) -> None:
    rng = np.random.default_rng(n)
    for _ in range(20):
        values = rng.uniform(0.5, 2.0, min(6, n))
        values[-1] = smallest
        J = with_singular_values(rng, n, values)
        P = np.empty((n, 6))
        pseudo_inverse(J, P)
        expected = np.linalg.pinv(J, SINGULAR)
        # Rounding grows with the condition, as far as directions count.
        kept = values[values > SINGULAR * values.max(initial=0.0)].min(initial=1.0)
        np.testing.assert_allclose(P, expected, atol=1e-13 / kept**2 + 1e-12)


def test_a_robot_that_cannot_move_the_tool_gets_no_motion() -> None:
    P = np.empty((6, 6))
    pseudo_inverse(np.zeros((6, 6)), P)
    assert not P.any()


@pytest.mark.parametrize('n', [1, 3, 5, 6, 7, 9])
@pytest.mark.parametrize('smallest', [1.0, 1e-3, 1e-6, 1e-8, 1e-11, 0.0])
def test_a_motion_is_that_of_the_pseudo_inverse(n: int, smallest: float) -> None:
    rng = np.random.default_rng(n)
    for _ in range(20):
        values = rng.uniform(0.5, 2.0, min(6, n))
        values[-1] = smallest
        J, x = with_singular_values(rng, n, values), rng.normal(size=6)
        y = np.empty(n)
        least_motion(J, x, y)
        kept = values[values > SINGULAR * values.max(initial=0.0)].min(initial=1.0)
        np.testing.assert_allclose(y, np.linalg.pinv(J, SINGULAR) @ x, atol=1e-12 / kept**2 + 1e-12)


@pytest.mark.parametrize('n', [2, 5, 6, 7, 9])
@pytest.mark.parametrize('smallest', [1.0, 1e-3, 1e-6])
def test_a_motion_that_is_possible_is_made_as_exactly_as_numbers_allow(n: int, smallest: float) -> None:
    rng = np.random.default_rng(n)
    for _ in range(20):
        values = rng.uniform(0.5, 2.0, min(6, n))
        values[-1] = smallest
        J = with_singular_values(rng, n, values)
        x = J @ rng.normal(size=n)
        y = np.empty(n)
        least_motion(J, x, y)
        # Backward stable: what the joints make of the tool's motion does not feel the condition.
        np.testing.assert_allclose(J @ y, x, atol=1e-14 * (1.0 + np.abs(J).sum() * np.abs(y).max()))
