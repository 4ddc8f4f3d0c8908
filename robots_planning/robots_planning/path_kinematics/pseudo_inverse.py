# ruff: noqa: C901, PLR0912  # compiled loops over arrays
"""The pseudo-inverse of a Jacobian, and its product with a twist of the tool, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import copy_into
from robots_core.validation import Array

# Ratio of singular values below which a direction is left out of the pseudo-inverse.
SINGULAR = 1e-9
# Ratio of the entries on the diagonal of R below which the singular values are checked. It is never below the
# ratio of the singular values.
SUSPICIOUS = 1e-7
# Ratio below which a column is zero but for rounding.
NOTHING = 1e-13


class Scratch(NamedTuple):
    """Memory for decompositions of Jacobians (6, n).

    Attributes:
        P: A pseudo-inverse, (n, 6).
        Q: (m + 1, m + 1), m the larger one of 6 and n.
        R: (m + 1, m + 1).
    """

    P: Array
    Q: Array
    R: Array


@compiled()
def scratch_for(n: int) -> Scratch:
    """Memory for a robot of n axes."""
    size = max(n, 6) + 1
    return Scratch(np.empty((n, 6)), np.empty((size, size)), np.empty((size, size)))


@compiled()
def pseudo_inverse(J: Array, P: Array, scratch: Scratch) -> None:
    """Fill the pseudo-inverse P (n, 6) of a Jacobian J (6, n).

    Computed by QR decomposition of the transpose, with Gram-Schmidt done twice (Giraud et al. 2005); close to
    a singularity by singular value decomposition, without the directions whose singular value is below
    `SINGULAR` times the largest.
    """
    n = J.shape[1]
    if n < 6:  # `apply_pseudo_inverse` needs it close to singularities alone
        _by_singular_values(J, P)
        return
    Q, R = scratch.Q, scratch.R
    largest, smallest = 0.0, np.inf
    for j in range(6):
        for k in range(n):
            Q[k, j] = J[j, k]
        for i in range(j):
            R[i, j] = 0.0
        length = 0.0
        for _ in range(2):
            for i in range(j):
                part = 0.0
                for k in range(n):
                    part += Q[k, i] * Q[k, j]
                R[i, j] += part
                for k in range(n):
                    Q[k, j] -= part * Q[k, i]
        for k in range(n):
            length += Q[k, j] * Q[k, j]
        length = sqrt(length)
        largest, smallest = max(largest, length), min(smallest, length)
        if not length > NOTHING * largest:
            _by_singular_values(J, P)
            return
        R[j, j] = length
        for k in range(n):
            Q[k, j] /= length
    # J^T = Q R, J^+ = Q R^-T
    for k in range(n):
        for j in range(5, -1, -1):
            value = Q[k, j]
            for i in range(j + 1, 6):
                value -= R[j, i] * P[k, i]
            P[k, j] = value / R[j, j]
    # The product of both norms is at least the ratio of the singular values.
    if smallest <= SUSPICIOUS * largest and SINGULAR**2 * _square(J) * _square(P) >= 1.0:
        _by_singular_values(J, P)


@compiled()
def _by_singular_values(J: Array, P: Array) -> None:
    inverse = np.linalg.pinv(J, SINGULAR)
    for k in range(J.shape[1]):
        copy_into(P[k], inverse[k])


@compiled()
def _square(A: Array) -> float:
    """Square of the Frobenius norm."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += A[i, j] * A[i, j]
    return total


@compiled()
def apply_pseudo_inverse(J: Array, x: Array, y: Array, scratch: Scratch) -> None:
    """Fill y (n,) with J^+ x, the minimum-norm least-squares solution of J y = x, for a twist x (6,).

    The result is that of `pseudo_inverse`. Up to six axes it takes half the time: with x as one more column
    of J, a single pass of Gram-Schmidt is accurate enough (Bjorck 1967).
    """
    if J.shape[1] > 6 or not _solve(J, x, y, scratch):
        pseudo_inverse(J, scratch.P, scratch)
        multiply(scratch.P, x, y)


@compiled()
def _solve(J: Array, x: Array, y: Array, scratch: Scratch) -> bool:
    """Fill y (n,), n <= 6, with the least squares solution of J y = x; False close to a singularity."""
    n = J.shape[1]
    Q, R = scratch.Q, scratch.R  # columns of Q as rows
    largest, smallest = 0.0, np.inf
    for j in range(n + 1):
        for k in range(6):
            Q[j, k] = J[k, j] if j < n else x[k]
        for i in range(j):
            part = 0.0
            for k in range(6):
                part += Q[i, k] * Q[j, k]
            R[i, j] = part
            for k in range(6):
                Q[j, k] -= part * Q[i, k]
        if j == n:
            break
        length = 0.0
        for k in range(6):
            length += Q[j, k] * Q[j, k]
        length = sqrt(length)
        largest, smallest = max(largest, length), min(smallest, length)
        if not smallest > SUSPICIOUS * largest:
            return False
        R[j, j] = 1.0 / length
        for k in range(6):
            Q[j, k] *= R[j, j]
    for j in range(n - 1, -1, -1):
        value = R[j, n]
        for i in range(j + 1, n):
            value -= R[j, i] * y[i]
        y[j] = value * R[j, j]
    return True


@compiled()
def multiply(A: Array, x: Array, y: Array) -> None:
    """Fill y (m,) with A x, A (m, n): for a few rows, without a library call."""
    for i in range(A.shape[0]):
        value = 0.0
        for j in range(A.shape[1]):
            value += A[i, j] * x[j]
        y[i] = value


@compiled()
def multiply_transposed(A: Array, x: Array, y: Array) -> None:
    """Fill y (n,) with A^T x, A (m, n)."""
    for j in range(A.shape[1]):
        value = 0.0
        for i in range(A.shape[0]):
            value += A[i, j] * x[i]
        y[j] = value
