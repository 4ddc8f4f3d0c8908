# ruff: noqa: C901, PLR0912  # compiled loops over arrays
"""Least joint motion for a motion of the tool: the pseudo-inverse, compiled."""

from __future__ import annotations

from math import sqrt

import numpy as np

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

# Ratio of singular values below which a direction of the tool counts as lost.
SINGULAR = 1e-9
# Ratio of the triangle's diagonal below which singular values are looked at; it is never far below theirs.
SUSPICIOUS = 1e-7


@compiled()
def pseudo_inverse(J: Array, P: Array) -> None:
    """Fill the pseudo-inverse P (n, 6) of a Jacobian J (6, n).

    By orthogonal triangular decomposition, Gram-Schmidt done twice (Giraud et al. 2005). Close to a
    singularity by singular values; directions with one below `SINGULAR` of the largest are left out.
    """
    n = J.shape[1]
    wide = n >= 6
    rows, columns = (n, 6) if wide else (6, n)
    Q, R = np.empty((rows, columns)), np.zeros((columns, columns))
    largest, smallest = 0.0, np.inf
    for j in range(columns):
        for k in range(rows):
            Q[k, j] = J[j, k] if wide else J[k, j]
        length = 0.0
        for _ in range(2):
            for i in range(j):
                part = 0.0
                for k in range(rows):
                    part += Q[k, i] * Q[k, j]
                R[i, j] += part
                for k in range(rows):
                    Q[k, j] -= part * Q[k, i]
        for k in range(rows):
            length += Q[k, j] * Q[k, j]
        length = sqrt(length)
        largest, smallest = max(largest, length), min(smallest, length)
        if not length > SUSPICIOUS * largest:
            break
        R[j, j] = length
        for k in range(rows):
            Q[k, j] /= length
    if not smallest > SUSPICIOUS * largest:
        P[:] = np.linalg.pinv(J, SINGULAR)
        return
    # A = Q R, A^+ = R^-1 Q^T; of the transpose, transposed.
    y = np.empty(columns)
    for k in range(rows):
        for j in range(columns - 1, -1, -1):
            value = Q[k, j]
            for i in range(j + 1, columns):
                value -= R[j, i] * y[i]
            y[j] = value / R[j, j]
        for j in range(columns):
            if wide:
                P[k, j] = y[j]
            else:
                P[j, k] = y[j]


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
