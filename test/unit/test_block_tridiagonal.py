"""BlockTridiagonal next to NumPy's solution of the dense equations."""

import numpy as np
import pytest

from robots_planning.paths.spline_pieces import BlockTridiagonal


@pytest.mark.parametrize(('count', 'size', 'sides'), [(1, 3, ()), (2, 3, ()), (7, 3, (2,)), (9, 1, (3,))])
def test_the_unknowns_are_those_of_the_dense_equations(count: int, size: int, sides: tuple[int, ...]) -> None:
    rng = np.random.default_rng(count)
    lower, upper = rng.uniform(-1.0, 1.0, (2, count - 1, size, size))
    # Each diagonal block outweighs its neighbours, so that no pivoting is needed.
    diagonal = rng.uniform(-1.0, 1.0, (count, size, size)) + 4.0 * size * np.eye(size)
    dense = np.zeros((count, size, count, size))
    for k in range(count):
        dense[k, :, k] = diagonal[k]
        if k:
            dense[k, :, k - 1], dense[k - 1, :, k] = lower[k - 1], upper[k - 1]
    right = rng.normal(size=(count, size, *sides))
    given = right.copy()
    found = BlockTridiagonal(lower, diagonal, upper).solve(right)
    rows = count * size
    expected = np.linalg.solve(dense.reshape(rows, rows), right.reshape(rows, -1)).reshape(right.shape)
    np.testing.assert_allclose(found, expected, atol=1e-14)
    np.testing.assert_array_equal(right, given)
