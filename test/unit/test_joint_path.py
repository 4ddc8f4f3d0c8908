"""JointPath: the quintics between its samples, and samples that make no path."""

import numpy as np
import pytest

from robots_core.errors import InvalidInputError
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.quintic import quintic_extremes


def curve(s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A quintic and a line."""
    s = s[:, None]
    first = np.hstack([s**5 - 2.0 * s**3 + s, 3.0 * s])
    return (
        first,
        np.hstack([5.0 * s**4 - 6.0 * s**2 + 1.0, 3.0 + 0.0 * s]),
        np.hstack([20.0 * s**3 - 12.0 * s, 0.0 * s]),
    )


def test_a_quintic_is_met_everywhere() -> None:
    s = np.array([0.0, 0.1, 0.45, 1.0])
    path = JointPath(s, *curve(s))
    s = np.linspace(0.0, 1.0, 101)
    for found, expected in zip(path.evaluate(s), curve(s), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-11)  # rounding over squares of short intervals
    assert path.num_axes == 2


def test_outside_it_stays_at_its_ends() -> None:
    s = np.array([0.0, 1.0])
    path = JointPath(s, *curve(s))
    np.testing.assert_array_equal(path.evaluate(np.array([-0.5, 1.5]))[0], path.evaluate(s)[0])


@pytest.mark.parametrize(
    ('s', 'message'),
    [
        ([0.0, 0.5, 0.9], 'from 0 to 1'),
        ([0.0, 0.5, 0.5, 1.0], 'increase'),
        ([0.1, 0.5, 1.0], 'from 0 to 1'),
        ([0.0, np.nan, 1.0], 'not finite'),
        ([0.0], 'k >= 2'),
    ],
)
def test_samples_that_make_no_path_are_refused(s: list[float], message: str) -> None:
    samples = np.array(s)
    with pytest.raises(InvalidInputError, match=message):
        JointPath(samples, *curve(np.nan_to_num(samples)))
    with pytest.raises(InvalidInputError, match='one shape'):
        JointPath(np.array([0.0, 1.0]), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 2)))


def test_extremes_are_those_of_a_fine_look() -> None:
    rng = np.random.default_rng(4)
    for c in rng.normal(size=(50, 6)):
        h = float(rng.uniform(0.1, 2.0))
        polynomial = np.polynomial.Polynomial(c)
        x = np.linspace(0.0, h, 20001)
        largest = [np.abs(polynomial.deriv(order)(x)).max() for order in (1, 2, 3)]
        first, second, third = quintic_extremes(c, h)
        # The second and third are exact; the samples miss an extreme by its curvature times the step squared.
        np.testing.assert_allclose([second, third], largest[1:], rtol=1e-6)
        assert first <= largest[0] * (1.0 + 1e-6)
        assert first >= 0.9 * largest[0]
