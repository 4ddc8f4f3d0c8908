"""The compiled pseudo-inverse next to NumPy's, in and around singularities."""

from collections.abc import Iterator

import numpy as np
import pytest

from robots_planning.path_kinematics.pseudo_inverse import SINGULAR, apply_pseudo_inverse, pseudo_inverse

AXES = [1, 3, 5, 6, 7, 9]
SMALLEST = [1.0, 1e-3, 1e-6, 1e-8, 1e-11, 0.0]


def jacobians(n: int, smallest: float) -> Iterator[tuple[np.ndarray, float]]:
    """Random Jacobians with a given smallest singular value, and the smallest one above `SINGULAR`."""
    rng, size = np.random.default_rng(n), min(6, n)
    for _ in range(20):
        values = rng.uniform(0.5, 2.0, size)
        values[-1] = smallest
        U = np.linalg.qr(rng.normal(size=(6, size)))[0]
        V = np.linalg.qr(rng.normal(size=(n, size)))[0]
        kept = values[values > SINGULAR * values.max(initial=0.0)].min(initial=1.0)
        yield np.ascontiguousarray(U * values @ V.T), float(kept)


@pytest.mark.parametrize('n', AXES)
@pytest.mark.parametrize('smallest', SMALLEST)
def test_is_the_pseudo_inverse(n: int, smallest: float) -> None:
    for J, kept in jacobians(n, smallest):
        P = pseudo_inverse(J)
        # Rounding grows with the condition, as far as directions count.
        np.testing.assert_allclose(P, np.linalg.pinv(J, SINGULAR), atol=1e-13 / kept**2 + 1e-12)


@pytest.mark.parametrize('n', AXES)
@pytest.mark.parametrize('smallest', SMALLEST)
def test_applying_it_is_the_product_with_the_pseudo_inverse(n: int, smallest: float) -> None:
    x = np.random.default_rng(0).normal(size=6)
    for J, kept in jacobians(n, smallest):
        y = apply_pseudo_inverse(J, x)
        np.testing.assert_allclose(y, np.linalg.pinv(J, SINGULAR) @ x, atol=1e-12 / kept**2 + 1e-12)


@pytest.mark.parametrize('n', AXES)
@pytest.mark.parametrize('smallest', [1.0, 1e-3, 1e-6])
def test_a_feasible_twist_is_reached_to_rounding(n: int, smallest: float) -> None:
    wanted = np.random.default_rng(0).normal(size=n)
    for J, _ in jacobians(n, smallest):
        y = apply_pseudo_inverse(J, J @ wanted)
        # Backward stable: the residual does not grow with the condition number.
        np.testing.assert_allclose(J @ y, J @ wanted, atol=1e-14 * (1.0 + np.abs(J).sum() * np.abs(y).max()))


def test_a_zero_jacobian_gives_zero() -> None:
    assert not pseudo_inverse(np.zeros((6, 6))).any()
    assert not apply_pseudo_inverse(np.zeros((6, 6)), np.ones(6)).any()
