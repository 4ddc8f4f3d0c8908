"""Small symmetric systems solved by Cholesky's method, compiled: for a few rows, without a library call."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

# Of a matrix that is singular up to rounding.
SMALLEST_PIVOT = 1e-18


@compiled()
def factorise(A: Array, L: Array) -> None:
    """Fill the lower triangle of L with the Cholesky factor of A, (n, n); L may be A."""
    for j in range(A.shape[0]):
        for i in range(j, A.shape[0]):
            value = A[i, j]
            for k in range(j):
                value -= L[i, k] * L[j, k]
            L[i, j] = sqrt(max(value, SMALLEST_PIVOT)) if i == j else value / L[j, j]


@compiled()
def damped_gram(J: Array, damping: float, L: Array) -> None:
    """Fill the lower triangle of L with the Cholesky factor of J J^T + damping I, for J (m, n)."""
    for i in range(J.shape[0]):
        for j in range(i + 1):
            value = damping if i == j else 0.0
            for k in range(J.shape[1]):
                value += J[i, k] * J[j, k]
            L[i, j] = value
    factorise(L, L)


@compiled()
def solve_lower(L: Array, b: Array) -> None:
    """Replace b (n,) by L^-1 b, with the lower triangle of L."""
    for i in range(b.size):
        value = b[i]
        for k in range(i):
            value -= L[i, k] * b[k]
        b[i] = value / L[i, i]


@compiled()
def solve_transposed(L: Array, b: Array) -> None:
    """Replace b (n,) by L^-T b, with the lower triangle of L."""
    for i in range(b.size - 1, -1, -1):
        value = b[i]
        for k in range(i + 1, b.size):
            value -= L[k, i] * b[k]
        b[i] = value / L[i, i]


@compiled()
def solve_free(A: Array, stands: NDArray[np.bool_], L: Array, w: Array) -> None:
    """Replace b in w by the solution of A w = b, with those at rest fixed at zero; L (m, m) is memory."""
    for i in range(w.size):
        for j in range(i + 1):
            L[i, j] = A[i, j]
            if stands[i] or stands[j]:
                L[i, j] = 1.0 if i == j else 0.0
        if stands[i]:
            w[i] = 0.0
    factorise(L, L)
    solve_lower(L, w)
    solve_transposed(L, w)
