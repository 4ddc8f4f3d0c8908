# ruff: noqa: PLR0917, C901  # compiled loops over arrays
"""A small dense quadratic program with bounds and rows, compiled."""

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots_core.kernels.compiled import compiled
from robots_core.kernels.small_matrices import factorise, solve_lower, solve_transposed
from robots_core.kernels.vectors import copy_into
from robots_core.validation import Array

SOLVED = 0
INFEASIBLE = 1
EXHAUSTED = 2
MAX_ITERATIONS = 200
# A violation below this is rounding of sums of terms of order one.
TOLERANCE = 1e-11
# Multipliers this far below zero, relative to the largest, are rounding.
ROUNDING = 1e-9
# A step direction shorter than this, relative to the constraint, is rounding: the constraint depends on the
# active ones.
DEPENDENT = 1e-12


class ActiveSet(NamedTuple):
    """Active constraints of a program in the variables y = L^T x, with the last row for one that enters.

    Attributes:
        number: Which constraint each is, (n + 1,).
        side: The side of every constraint that is active, +1 (high) or -1 (low); 0 of others, (n + m,).
        normal: Normal of the one that enters, which points inwards, (n,): a row of D.
        bound: b of D y >= b, (n + 1,).
        Q: Orthonormal rows, (n + 1, n): D = R^T Q.
        R: Upper triangle, (n + 1, n + 1).
        u: Multipliers, (n + 1,).
    """

    number: NDArray[np.int64]
    side: Array
    normal: Array
    bound: Array
    Q: Array
    R: Array
    u: Array


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
def solve_factorised(
    L: Array, f: Array, low: Array, high: Array, C: Array, x: Array, multipliers: Array
) -> int:
    """`solve_quadratic_program` for H = L L^T: the point y = L^T x closest to y0 = -L^-1 f.

    Constraint p is bound p of x, or row p - n.
    """
    n = f.size
    y0, y, r = -f, np.empty(n), np.empty(n)
    set_ = ActiveSet(
        np.empty(n + 1, np.int64),
        np.zeros(low.size),
        np.empty(n),
        np.empty(n + 1),
        np.empty((n + 1, n)),
        np.empty((n + 1, n + 1)),
        np.zeros(n + 1),
    )
    solve_lower(L, y0)
    copy_into(y, y0)
    multipliers[:] = 0.0
    count, fresh = 0, True
    for _ in range(MAX_ITERATIONS):
        copy_into(x, y)
        solve_transposed(L, x)
        chosen, side = _most_violated(low, high, C, x, set_.side)
        if chosen >= 0:
            _enter(L, C, low, high, chosen, side, count, set_)
            status, count = _make_active(y, r, count, set_)
            if status != SOLVED:
                return status
            fresh = False
        elif fresh:
            for k in range(count):
                p = set_.number[k]
                multipliers[p] = set_.side[p] * max(set_.u[k], 0.0)
            return SOLVED
        else:
            # Multipliers may have been large in earlier iterations, with large rounding errors.
            _recompute(y0, y, count, set_)
            fresh = True
            leaving, largest = 0, 0.0
            for k in range(count):
                largest = max(largest, abs(set_.u[k]))
                if set_.u[k] < set_.u[leaving]:
                    leaving = k
            if set_.u[leaving] < -ROUNDING * (1.0 + largest):
                _drop(set_, leaving, count)
                count -= 1
                _recompute(y0, y, count, set_)
                fresh = False
    return EXHAUSTED


@compiled(counted=False)
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


@compiled(counted=False, inlined=True)
def _enter(
    L: Array, C: Array, low: Array, high: Array, chosen: int, side: float, count: int, set_: ActiveSet
) -> None:
    """Write a constraint behind the active ones."""
    n = L.shape[0]
    normal = set_.normal
    for i in range(n):
        normal[i] = -side * C[chosen - n, i] if chosen >= n else 0.0
    if chosen < n:
        normal[chosen] = -side
    solve_lower(L, normal)
    set_.number[count], set_.side[chosen], set_.u[count] = chosen, side, 0.0
    set_.bound[count] = -high[chosen] if side > 0.0 else low[chosen]


@compiled(counted=False, inlined=True)
def _make_active(y: Array, r: Array, count: int, set_: ActiveSet) -> tuple[int, int]:
    """Move y to the entering constraint, and drop those that become inactive; a status and the new count."""
    Q, R, u = set_.Q, set_.R, set_.u
    for _ in range(MAX_ITERATIONS):
        length, rest = _orthogonalise(set_, count)
        for i in range(count - 1, -1, -1):
            value = R[i, count]
            for j in range(i + 1, count):
                value -= R[i, j] * r[j]
            r[i] = value / R[i, i]
        partial, leaving = inf, -1
        for k in range(count):
            if r[k] > 0.0 and u[k] < partial * r[k]:
                partial, leaving = u[k] / r[k], k
        full = inf
        if count < y.size and rest > DEPENDENT * length:
            gap = set_.bound[count]
            for i in range(y.size):
                gap -= set_.normal[i] * y[i]
            full = gap / rest
        step = min(partial, full)
        if step == inf:
            return INFEASIBLE, count
        for k in range(count):
            u[k] -= step * r[k]
        u[count] += step
        if full < inf:
            for i in range(y.size):
                y[i] += step * sqrt(rest) * Q[count, i]
        if full <= partial:
            return SOLVED, count + 1
        _drop(set_, leaving, count)
        count -= 1
    return EXHAUSTED, count


@compiled(counted=False, inlined=True)
def _orthogonalise(set_: ActiveSet, k: int) -> tuple[float, float]:
    """Fill row k of Q and column k of R; the squares of the normal, and of its part across those before.

    Gram-Schmidt, done twice (Giraud et al. 2005).
    """
    Q, R = set_.Q, set_.R
    n = Q.shape[1]
    length, rest = 0.0, 0.0
    for i in range(n):
        Q[k, i] = set_.normal[i]
        length += Q[k, i] * Q[k, i]
    for j in range(k):
        R[j, k] = 0.0
    for _ in range(2):
        for j in range(k):
            part = 0.0
            for i in range(n):
                part += Q[j, i] * Q[k, i]
            R[j, k] += part
            for i in range(n):
                Q[k, i] -= part * Q[j, i]
    for i in range(n):
        rest += Q[k, i] * Q[k, i]
    R[k, k] = sqrt(rest)
    if rest > 0.0:
        for i in range(n):
            Q[k, i] /= R[k, k]
    return length, rest


@compiled(counted=False, inlined=True)
def _drop(set_: ActiveSet, leaving: int, count: int) -> None:
    """Remove one of `count` active constraints; those behind it move up, one that enters too.

    Givens' rotations make R, less a column, a triangle again.
    """
    Q, R = set_.Q, set_.R
    set_.side[set_.number[leaving]] = 0.0
    for k in range(leaving, count):
        set_.number[k], set_.bound[k], set_.u[k] = set_.number[k + 1], set_.bound[k + 1], set_.u[k + 1]
    for k in range(leaving, count - 1):
        for i in range(k + 2):
            R[i, k] = R[i, k + 1]
    for k in range(leaving, count - 1):
        length = sqrt(R[k, k] ** 2 + R[k + 1, k] ** 2)
        cosine, sine = R[k, k] / length, R[k + 1, k] / length
        R[k, k] = length
        for j in range(k + 1, count - 1):
            R[k, j], R[k + 1, j] = (
                cosine * R[k, j] + sine * R[k + 1, j],
                cosine * R[k + 1, j] - sine * R[k, j],
            )
        for i in range(Q.shape[1]):
            Q[k, i], Q[k + 1, i] = (
                cosine * Q[k, i] + sine * Q[k + 1, i],
                cosine * Q[k + 1, i] - sine * Q[k, i],
            )


@compiled(counted=False)
def _recompute(y0: Array, y: Array, count: int, set_: ActiveSet) -> None:
    """Fill y and u from the active constraints: R u = v, y = y0 + Q^T v, v = R^-T b - Q y0."""
    Q, R, u = set_.Q, set_.R, set_.u
    for i in range(y.size):
        y[i] = y0[i]
    for k in range(count):
        value = set_.bound[k]
        for i in range(k):
            value -= R[i, k] * u[i]
        u[k] = value / R[k, k]
    for k in range(count):
        for i in range(y0.size):
            u[k] -= Q[k, i] * y0[i]
        for i in range(y0.size):
            y[i] += u[k] * Q[k, i]
    for k in range(count - 1, -1, -1):
        for j in range(k + 1, count):
            u[k] -= R[k, j] * u[j]
        u[k] /= R[k, k]
