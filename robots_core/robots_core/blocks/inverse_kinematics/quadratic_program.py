# ruff: noqa: PLR0917, C901, PLR0912, PLR0915  # one compiled loop over arrays
"""A small dense quadratic program with bounds and rows, compiled."""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

SOLVED = 0
INFEASIBLE = 1
EXHAUSTED = 2
MAX_ITERATIONS = 200
# Of a matrix that is singular up to rounding.
SMALLEST_PIVOT = 1e-18
# A violation below this is rounding of sums of terms of order one.
TOLERANCE = 1e-11
# Multipliers this far below zero, relative to the largest, are rounding.
ROUNDING = 1e-9
# A step direction shorter than this, relative to the constraint, is rounding: the constraint depends on the
# active ones.
DEPENDENT = 1e-12


@compiled()
def solve_quadratic_program(
    H: Array, f: Array, low: Array, high: Array, C: Array, x: Array, multipliers: Array
) -> int:
    """Minimise x^T H x / 2 + f^T x subject to low <= (x, C x) <= high.

    Dual active-set method of Goldfarb and Idnani (1983): it starts at the minimum without constraints and
    adds the most violated one, so that few active limits take few steps. Bounds of x come first, which cost
    next to nothing; rows are checked once x keeps its bounds.

    Args:
        H: Symmetric, positive definite, (n, n).
        f: (n,).
        low: Of x, then of the rows, (n + m,).
        high: (n + m,), not below `low`; both may be infinite.
        C: (m, n).
        x: Filled: the solution, (n,).
        multipliers: Filled: (n + m,), above zero where `high` is active, below zero where `low` is.

    Returns:
        SOLVED, INFEASIBLE or EXHAUSTED.
    """
    L = np.empty(H.shape)
    factorise(H, L)
    return solve_factorised(L, f, low, high, C, x, multipliers)


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
    L: Array, f: Array, low: Array, high: Array, C: Array, x: Array, multipliers: Array
) -> int:
    """`solve_quadratic_program` for H = L L^T.

    Constraint p is bound p of x, or row p - n, on the side +1 (high) or -1 (low); with N the matrix of active
    normals, K = Q^T L^-1 is kept such that K N = (R, 0), R upper triangular.
    """
    n = f.size
    K, R = np.zeros((n, n)), np.empty((n, n))
    active, sides = np.empty(n, np.int64), np.zeros(low.size)
    u, d, z, r, normal = np.empty(n + 1), np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    _invert(L, K)
    x[:] = 0.0
    for j in range(n):
        value = 0.0
        for i in range(j + 1):
            value += K[j, i] * f[i]
        for i in range(j + 1):
            x[i] -= value * K[j, i]
    multipliers[:] = 0.0
    count, iterations, fresh = 0, 0, False
    while True:
        chosen, side = _most_violated(low, high, C, x, sides)
        if chosen < 0:
            if fresh or count == 0:
                for k in range(count):
                    multipliers[active[k]] = sides[active[k]] * max(u[k], 0.0)
                return SOLVED
            # Multipliers may have been large in earlier iterations, with large rounding errors.
            _recompute(K, R, f, low, high, sides, active, count, x, u)
            fresh = True
            leaving, largest = 0, 0.0
            for k in range(count):
                largest = max(largest, abs(u[k]))
                if u[k] < u[leaving]:
                    leaving = k
            if u[leaving] < -ROUNDING * (1.0 + largest):
                _drop(K, R, active, sides, u, leaving, count)
                count -= 1
                _recompute(K, R, f, low, high, sides, active, count, x, u)
                fresh = False
            iterations += 1
            if iterations > MAX_ITERATIONS:
                return EXHAUSTED
            continue
        fresh = False
        # The normal points inwards.
        if chosen < n:
            normal[:] = 0.0
            normal[chosen] = -side
        else:
            for i in range(n):
                normal[i] = -side * C[chosen - n, i]
        bound = high[chosen] if side > 0.0 else -low[chosen]
        u[count] = 0.0
        while True:
            iterations += 1
            if iterations > MAX_ITERATIONS:
                return EXHAUSTED
            length, rest = 0.0, 0.0
            for j in range(n):
                value = 0.0
                if chosen < n:
                    value = -side * K[j, chosen]
                else:
                    for i in range(n):
                        value += K[j, i] * normal[i]
                d[j] = value
                length += value * value
                if j >= count:
                    rest += value * value
            z[:] = 0.0
            for j in range(count, n):
                for i in range(n):
                    z[i] += d[j] * K[j, i]
            for i in range(count - 1, -1, -1):
                value = d[i]
                for j in range(i + 1, count):
                    value -= R[i, j] * r[j]
                r[i] = value / R[i, i]
            partial, leaving = inf, -1
            for k in range(count):
                if r[k] > 0.0 and u[k] < partial * r[k]:
                    partial, leaving = u[k] / r[k], k
            full = inf
            if count < n and rest > DEPENDENT * length:
                gap = bound
                for i in range(n):
                    gap += normal[i] * x[i]
                full = -gap / rest
            step = min(partial, full)
            if step == inf:
                return INFEASIBLE
            for k in range(count):
                u[k] -= step * r[k]
            u[count] += step
            if full < inf:
                for i in range(n):
                    x[i] += step * z[i]
            if full <= partial:
                _add(K, R, d, z, rest, count)
                active[count] = chosen
                sides[chosen] = side
                count += 1
                break
            _drop(K, R, active, sides, u, leaving, count)
            count -= 1


@compiled()
def _invert(L: Array, K: Array) -> None:
    """Fill the lower triangle of K with the inverse of that of L, (n, n)."""
    for i in range(L.shape[0]):
        inverse = 1.0 / L[i, i]
        for k in range(i):
            for j in range(k + 1):
                K[i, j] -= L[i, k] * K[k, j]
        for j in range(i):
            K[i, j] *= inverse
        K[i, i] = inverse


@compiled()
def _most_violated(low: Array, high: Array, C: Array, x: Array, sides: Array) -> tuple[int, float]:
    """The constraint that x violates most, bounds first, and its side; -1 if there is none."""
    n = x.size
    worst, chosen, side = TOLERANCE, -1, 0.0
    for p in range(n):
        if sides[p] == 0.0:
            if x[p] - high[p] > worst:
                worst, chosen, side = x[p] - high[p], p, 1.0
            if low[p] - x[p] > worst:
                worst, chosen, side = low[p] - x[p], p, -1.0
    if chosen >= 0:
        return chosen, side
    for p in range(n, low.size):
        if sides[p] == 0.0:
            value, square = 0.0, 0.0
            for i in range(n):
                value += C[p - n, i] * x[i]
                square += C[p - n, i] * C[p - n, i]
            over = max(value - high[p], low[p] - value)
            if over > 0.0 and over > worst * sqrt(square):
                worst, chosen = over / sqrt(square), p
                side = 1.0 if value > high[p] else -1.0
    return chosen, side


@compiled()
def _drop(
    K: Array, R: Array, active: NDArray[np.int64], sides: Array, u: Array, leaving: int, count: int
) -> None:
    """Remove an active constraint; later multipliers, that of the entering one included, move up."""
    sides[active[leaving]] = 0.0
    for k in range(leaving, count - 1):
        active[k] = active[k + 1]
        u[k] = u[k + 1]
    u[count - 1] = u[count]
    _remove(K, R, leaving, count)


@compiled()
def _recompute(
    K: Array,
    R: Array,
    f: Array,
    low: Array,
    high: Array,
    sides: Array,
    active: NDArray[np.int64],
    count: int,
    x: Array,
    u: Array,
) -> None:
    """Fill x and u from the active constraints: x = K^T y, R^T y_1 = b, y_2 = -K_2 f, R u = y_1 + K_1 f."""
    n = f.size
    y, slope = np.empty(n), np.empty(n)
    for j in range(n):
        slope[j] = 0.0
        for i in range(n):
            slope[j] += K[j, i] * f[i]
    for k in range(count):
        p = active[k]
        bound = -high[p] if sides[p] > 0.0 else low[p]
        for i in range(k):
            bound -= R[i, k] * y[i]
        y[k] = bound / R[k, k]
    for j in range(count, n):
        y[j] = -slope[j]
    x[:] = 0.0
    for j in range(n):
        for i in range(n):
            x[i] += y[j] * K[j, i]
    for k in range(count - 1, -1, -1):
        value = y[k] + slope[k]
        for j in range(k + 1, count):
            value -= R[k, j] * u[j]
        u[k] = value / R[k, k]


@compiled()
def _add(K: Array, R: Array, d: Array, z: Array, rest: float, count: int) -> None:
    """Reflect the rows of K behind `count` so that the new constraint meets only the first of them.

    Householder's reflection I - 2 v v^T / v^T v with v = d_2 -+ |d_2| e_1; K_2^T v is z -+ |d_2| K_2[0].
    """
    n = d.size
    norm = sqrt(rest) if d[count] < 0.0 else -sqrt(rest)
    for i in range(count):
        R[i, count] = d[i]
    R[count, count] = norm
    first = d[count] - norm
    # v^T v / 2 = |d_2|^2 -+ |d_2| d_2[0]
    factor = 1.0 / (rest - norm * d[count])
    for i in range(n):
        z[i] = factor * (z[i] - norm * K[count, i])
    for i in range(n):
        K[count, i] -= first * z[i]
    for j in range(count + 1, n):
        for i in range(n):
            K[j, i] -= d[j] * z[i]


@compiled()
def _remove(K: Array, R: Array, leaving: int, count: int) -> None:
    """Drop column `leaving` of R and rotate the rest upper triangular again."""
    n = K.shape[0]
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
            first, second = K[k, i], K[k + 1, i]
            K[k, i] = cosine * first + sine * second
            K[k + 1, i] = cosine * second - sine * first
