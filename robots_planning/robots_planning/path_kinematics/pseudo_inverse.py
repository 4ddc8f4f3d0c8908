"""The pseudo-inverse of a Jacobian, and its product with a twist of the tool, compiled."""

from math import sqrt

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

# Ratio of singular values below which a direction is left out of the pseudo-inverse.
SINGULAR = 1e-9
# Ratio of the entries on the diagonal of R below which the singular values are checked. It is never below the
# ratio of the singular values.
SUSPICIOUS = 1e-7
# Ratio below which a column is zero except for rounding.
NOTHING = 1e-13


@compiled()
def pseudo_inverse(J: Array) -> Array:
    """The pseudo-inverse, (n, 6), of a Jacobian J (6, n).

    Computed by QR decomposition of the transpose, with Gram-Schmidt done twice (Giraud et al. 2005); close to
    a singularity by singular value decomposition, without the directions whose singular value is below
    `SINGULAR` times the largest.
    """
    n = J.shape[1]
    Q, R, P = J.copy(), np.zeros((6, 6)), np.empty((n, 6))
    ratio = _orthonormalise(Q, R, 6, 2)
    if n < 6 or ratio == 0.0:
        P[:] = np.linalg.pinv(J, SINGULAR)
        return P
    # J^T = Q^T R, J^+ = Q^T R^-T
    for k in range(n):
        for j in range(5, -1, -1):
            value = Q[j, k]
            for i in range(j + 1, 6):
                value -= R[j, i] * P[k, i]
            P[k, j] = value / R[j, j]
    # The product of both norms is at least the ratio of the singular values.
    if ratio <= SUSPICIOUS and SINGULAR**2 * _square(J) * _square(P) >= 1.0:
        P[:] = np.linalg.pinv(J, SINGULAR)
    return P


@compiled()
def apply_pseudo_inverse(J: Array, x: Array) -> Array:
    """J^+ x (n,), the minimum-norm least-squares solution of J y = x, for a twist x (6,).

    The result is that of `pseudo_inverse`. Up to six axes it takes half the time: with x as one more column
    of J, a single pass of Gram-Schmidt is accurate enough (Bjorck 1967).
    """
    n = J.shape[1]
    if n > 6:
        return multiply(pseudo_inverse(J), x)
    Q, R, y = np.empty((n + 1, 6)), np.zeros((n + 1, n + 1)), np.empty(n)
    for k in range(6):
        for j in range(n):
            Q[j, k] = J[k, j]
        Q[n, k] = x[k]
    if _orthonormalise(Q, R, n, 1) <= SUSPICIOUS:
        return multiply(pseudo_inverse(J), x)
    for j in range(n - 1, -1, -1):
        value = R[j, n]
        for i in range(j + 1, n):
            value -= R[j, i] * y[i]
        y[j] = value / R[j, j]
    return y


@compiled()
def _orthonormalise(rows: Array, R: Array, count: int, passes: int) -> float:
    """Gram-Schmidt on the first `count` rows; what all have of them is taken off and added to R.

    Returns:
        Ratio of the shortest to the longest that is left of these rows; 0 where nothing is.
    """
    largest, smallest = 0.0, np.inf
    for j in range(rows.shape[0]):
        for _ in range(passes):
            for i in range(min(j, count)):
                part = 0.0
                for k in range(rows.shape[1]):
                    part += rows[i, k] * rows[j, k]
                R[i, j] += part
                for k in range(rows.shape[1]):
                    rows[j, k] -= part * rows[i, k]
        if j == count:
            break
        length = 0.0
        for k in range(rows.shape[1]):
            length += rows[j, k] * rows[j, k]
        R[j, j] = length = sqrt(length)
        largest, smallest = max(largest, length), min(smallest, length)
        if not length > NOTHING * largest:
            return 0.0
        for k in range(rows.shape[1]):
            rows[j, k] /= length
    return smallest / largest


@compiled()
def _square(A: Array) -> float:
    """Square of the Frobenius norm."""
    total = 0.0
    for value in A.flat:
        total += value * value
    return total


@compiled()
def multiply(A: Array, x: Array) -> Array:
    """A x (m,), A (m, n): for a few rows, without a library call."""
    y = np.empty(A.shape[0])
    for i in range(A.shape[0]):
        value = 0.0
        for j in range(A.shape[1]):
            value += A[i, j] * x[j]
        y[i] = value
    return y
