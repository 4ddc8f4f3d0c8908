# ruff: noqa: C901, PLR0912  # compiled loops over arrays
"""Least joint motion for a motion of the tool: the pseudo-inverse, compiled."""

from __future__ import annotations

from math import sqrt

import numpy as np

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

# Ratio of singular values below which a direction of the tool counts as lost.
SINGULAR = 1e-9
# Ratio of the triangle's diagonal, which is never below that of singular values, that makes them suspicious.
SUSPICIOUS = 1e-7
# And below which rounding is all that is left.
NOTHING = 1e-13


@compiled()
def pseudo_inverse(J: Array, P: Array) -> None:
    """Fill the pseudo-inverse P (n, 6) of a Jacobian J (6, n).

    By orthogonal triangular decomposition, Gram-Schmidt done twice (Giraud et al. 2005). In a singularity by
    singular values; directions with one below `SINGULAR` of the largest are left out.
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
        if not length > NOTHING * largest:
            P[:] = np.linalg.pinv(J, SINGULAR)
            return
        R[j, j] = length
        for k in range(rows):
            Q[k, j] /= length
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
    # The product of both norms is at least the ratio of the singular values.
    if smallest <= SUSPICIOUS * largest and SINGULAR**2 * _square(J) * _square(P) >= 1.0:
        P[:] = np.linalg.pinv(J, SINGULAR)


@compiled()
def _square(A: Array) -> float:
    """Square of the Frobenius norm."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += A[i, j] * A[i, j]
    return total


@compiled()
def least_motion(J: Array, x: Array, y: Array) -> None:
    """Fill y (n,) with J^+ x: the smallest joint motion that comes closest to a motion x (6,) of the tool.

    As with `pseudo_inverse`, and up to six axes in half its time: with x as one more column of J the
    decomposition need not be done twice (Bjorck 1967).
    """
    n = J.shape[1]
    if n > 6 or not _solve(J, x, y):
        P = np.empty((n, 6))
        pseudo_inverse(J, P)
        multiply(P, x, y)


@compiled()
def _solve(J: Array, x: Array, y: Array) -> bool:
    """Fill y (n,), n <= 6, with the least squares solution of J y = x; False close to a singularity."""
    n = J.shape[1]
    Q, R = np.empty((n + 1, 6)), np.empty((n, n + 1))  # columns of Q as rows
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
