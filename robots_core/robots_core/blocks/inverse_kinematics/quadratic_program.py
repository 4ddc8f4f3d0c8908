# ruff: noqa: PLR0917, C901, PLR0912, PLR0915  # one compiled loop over arrays
"""A small dense quadratic program with bounds and rows, compiled."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

SOLVED = 0
INFEASIBLE = 1
EXHAUSTED = 2
MAX_ITERATIONS = 200
# Of a matrix that is singular but for rounding.
SMALLEST_PIVOT = 1e-18
# A constraint broken by less is kept: rounding of sums of terms of order one.
TOLERANCE = 1e-11
# Multipliers this far below zero, relative to the largest, are rounding.
ROUNDING = 1e-9
# A step direction shorter than this, relative to the constraint, is rounding: the constraint depends on the
# active ones.
DEPENDENT = 1e-12


@compiled()
def solve_quadratic_program(
    H: Array, f: Array, low: Array, high: Array, C: Array, c: Array, x: Array, multipliers: Array
) -> int:
    """Minimise x^T H x / 2 + f^T x subject to low <= x <= high and C x <= c.

    Dual active-set method of Goldfarb and Idnani (1983), with Givens rotations: it starts at the minimum
    without constraints and adds the one broken most, so that few active limits take few steps.

    Args:
        H: Symmetric, positive definite, (n, n).
        f: (n,).
        low: (n,).
        high: (n,), not below `low`; both may be infinite.
        C: (m, n).
        c: (m,).
        x: Filled: the solution, (n,).
        multipliers: Filled: of low, high and rows, (2 n + m,); above zero where active.

    Returns:
        SOLVED, INFEASIBLE or EXHAUSTED.
    """
    L = np.empty(H.shape)
    factorise(H, L)
    return solve_factorised(L, f, low, high, C, c, x, multipliers)


@compiled()
def factorise(H: Array, L: Array) -> None:
    """Fill the lower triangle of L with the Cholesky factor of H, (n, n)."""
    for j in range(H.shape[0]):
        for i in range(j, H.shape[0]):
            value = H[i, j]
            for k in range(j):
                value -= L[i, k] * L[j, k]
            L[i, j] = sqrt(max(value, SMALLEST_PIVOT)) if i == j else value / L[j, j]


@compiled()
def solve_factorised(
    L: Array, f: Array, low: Array, high: Array, C: Array, c: Array, x: Array, multipliers: Array
) -> int:
    """`solve_quadratic_program` for H = L L^T."""
    n, m = f.size, c.size
    total = 2 * n + m
    # J = L^-T, columns; d = J^T normal.
    J = np.zeros((n, n))
    for j in range(n):
        J[j, j] = 1.0 / L[j, j]
        for i in range(j + 1, n):
            total_ij = 0.0
            for k in range(j, i):
                total_ij += L[i, k] * J[j, k]
            J[j, i] = -total_ij / L[i, i]
    y = np.zeros(n)
    for j in range(n):
        for i in range(n):
            y[j] += J[i, j] * f[i]
    for i in range(n):
        value = 0.0
        for j in range(n):
            value -= J[i, j] * y[j]
        x[i] = value
    scale = np.ones(total)
    for row in range(m):
        norm = 0.0
        for i in range(n):
            norm += C[row, i] * C[row, i]
        scale[2 * n + row] = sqrt(norm) if norm > 0.0 else 1.0
    multipliers[:] = 0.0
    R = np.zeros((n, n))
    active = np.zeros(n, np.int64)
    is_active = np.zeros(total, np.bool_)
    u = np.zeros(n + 1)
    d, z, r, normal = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    count = 0
    iterations = 0
    fresh = False
    while True:
        worst, chosen = -TOLERANCE, -1
        for p in range(total):
            if is_active[p]:
                continue
            gap = _gap(p, n, low, high, C, c, x) / scale[p]
            if gap < worst:
                worst, chosen = gap, p
        if chosen < 0:
            if fresh or count == 0:
                for k in range(count):
                    multipliers[active[k]] = max(u[k], 0.0)
                return SOLVED
            # Multipliers may have been huge on the way, and left their rounding behind.
            _recompute(J, R, f, low, high, c, active, count, x, u)
            fresh = True
            leaving = int(np.argmin(u[:count]))
            if u[leaving] < -ROUNDING * (1.0 + np.abs(u[:count]).max()):
                _drop(J, R, active, is_active, u, leaving, count)
                count -= 1
                _recompute(J, R, f, low, high, c, active, count, x, u)
                fresh = False
            iterations += 1
            if iterations > MAX_ITERATIONS:
                return EXHAUSTED
            continue
        fresh = False
        normal[:] = 0.0
        if chosen < n:
            normal[chosen] = 1.0
        elif chosen < 2 * n:
            normal[chosen - n] = -1.0
        else:
            for i in range(n):
                normal[i] = -C[chosen - 2 * n, i]
        u[count] = 0.0
        while True:
            iterations += 1
            if iterations > MAX_ITERATIONS:
                return EXHAUSTED
            length, rest = 0.0, 0.0
            for j in range(n):
                value = 0.0
                for i in range(n):
                    value += J[i, j] * normal[i]
                d[j] = value
                length += value * value
                if j >= count:
                    rest += value * value
            for i in range(n):
                value = 0.0
                for j in range(count, n):
                    value += J[i, j] * d[j]
                z[i] = value
            for i in range(count - 1, -1, -1):
                value = d[i]
                for j in range(i + 1, count):
                    value -= R[i, j] * r[j]
                r[i] = value / R[i, i]
            partial, leaving = np.inf, -1
            for k in range(count):
                if r[k] > 0.0 and u[k] < partial * r[k]:
                    partial, leaving = u[k] / r[k], k
            full = np.inf
            if count < n and rest > DEPENDENT * length:
                full = -_gap(chosen, n, low, high, C, c, x) / rest
            step = min(partial, full)
            if step == np.inf:
                return INFEASIBLE
            for k in range(count):
                u[k] -= step * r[k]
            u[count] += step
            if full < np.inf:
                for i in range(n):
                    x[i] += step * z[i]
            if full <= partial:
                _add(J, R, d, count)
                active[count] = chosen
                is_active[chosen] = True
                count += 1
                break
            _drop(J, R, active, is_active, u, leaving, count)
            count -= 1


@compiled()
def _drop(
    J: Array,
    R: Array,
    active: NDArray[np.int64],
    is_active: NDArray[np.bool_],
    u: Array,
    leaving: int,
    count: int,
) -> None:
    """Forget an active constraint; multipliers behind it, that of a coming one too, move up."""
    is_active[active[leaving]] = False
    for k in range(leaving, count - 1):
        active[k] = active[k + 1]
        u[k] = u[k + 1]
    u[count - 1] = u[count]
    _remove(J, R, leaving, count)


@compiled()
def _recompute(
    J: Array,
    R: Array,
    f: Array,
    low: Array,
    high: Array,
    c: Array,
    active: NDArray[np.int64],
    count: int,
    x: Array,
    u: Array,
) -> None:
    """Fill x and u from the active constraints: x = J y, R^T y_1 = b, y_2 = -J_2^T f, R u = y_1 + J_1^T f."""
    n = f.size
    y, slope = np.zeros(n), np.zeros(n)
    for j in range(n):
        for i in range(n):
            slope[j] += J[i, j] * f[i]
    for k in range(count):
        p = active[k]
        bound = low[p] if p < n else -high[p - n] if p < 2 * n else -c[p - 2 * n]
        for i in range(k):
            bound -= R[i, k] * y[i]
        y[k] = bound / R[k, k]
    for j in range(count, n):
        y[j] = -slope[j]
    for i in range(n):
        x[i] = 0.0
        for j in range(n):
            x[i] += J[i, j] * y[j]
    for k in range(count - 1, -1, -1):
        value = y[k] + slope[k]
        for j in range(k + 1, count):
            value -= R[k, j] * u[j]
        u[k] = value / R[k, k]


@compiled()
def _gap(p: int, n: int, low: Array, high: Array, C: Array, c: Array, x: Array) -> float:
    """How far x is inside constraint p; negative outside."""
    if p < n:
        return x[p] - low[p]  # type: ignore[no-any-return]
    if p < 2 * n:
        return high[p - n] - x[p - n]  # type: ignore[no-any-return]
    value = c[p - 2 * n]
    for i in range(n):
        value -= C[p - 2 * n, i] * x[i]
    return value  # type: ignore[no-any-return]


@compiled()
def _add(J: Array, R: Array, d: Array, count: int) -> None:
    """Rotate the columns of J behind `count` so that the new constraint meets only the first of them."""
    n = d.size
    for j in range(n - 1, count, -1):
        a, b = d[j - 1], d[j]
        if b == 0.0:
            continue
        h = sqrt(a * a + b * b)
        cosine, sine = a / h, b / h
        d[j - 1], d[j] = h, 0.0
        for i in range(n):
            first, second = J[i, j - 1], J[i, j]
            J[i, j - 1] = cosine * first + sine * second
            J[i, j] = cosine * second - sine * first
    for i in range(count + 1):
        R[i, count] = d[i]


@compiled()
def _remove(J: Array, R: Array, leaving: int, count: int) -> None:
    """Drop column `leaving` of R and rotate the rest upper triangular again."""
    n = J.shape[0]
    for k in range(leaving, count - 1):
        for i in range(k + 2):
            R[i, k] = R[i, k + 1]
    for k in range(leaving, count - 1):
        a, b = R[k, k], R[k + 1, k]
        h = sqrt(a * a + b * b)
        if h == 0.0:
            continue
        cosine, sine = a / h, b / h
        R[k, k], R[k + 1, k] = h, 0.0
        for j in range(k + 1, count - 1):
            first, second = R[k, j], R[k + 1, j]
            R[k, j] = cosine * first + sine * second
            R[k + 1, j] = cosine * second - sine * first
        for i in range(n):
            first, second = J[i, k], J[i, k + 1]
            J[i, k] = cosine * first + sine * second
            J[i, k + 1] = cosine * second - sine * first
