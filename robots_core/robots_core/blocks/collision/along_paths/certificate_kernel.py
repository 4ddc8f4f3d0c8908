# ruff: noqa: PLR0917  # compiled loops over arrays
"""Certificates that pieces of paths are free between their samples, compiled.

The method is that of `path_search`, on polynomials over [0, 1] in place of timed paths: an interval is free
if every pair of solids is farther apart in its middle than it can approach within the interval (Schwarzer,
Saha and Latombe 2005). Intervals are halved level by level, so that a piece that collides is left early.
"""

from math import sqrt

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import Indices, gap_along
from robots_core.blocks.collision.distances.pair_kernels import solid_distance
from robots_core.blocks.collision.distances.placed_solids import (
    BodyArrays,
    PlacedArrays,
    SolidArrays,
    approach,
    box_reach,
    broad_distance,
    forget_approaches,
    place,
)
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import dot, subtract
from robots_core.validation import Array

FINEST = 1e-4  # m of approach; a piece that is not proven to be free with less counts as blocked
FREE = -1  # in place of a pair


@compiled(counted=False)
def _keep_direction(solids: SolidArrays, i: int, j: int, result: Array, axis: Array) -> None:
    """Keep the direction from solid i to solid j, both convex, that `solid_distance` found."""
    first = solids[1]
    if first[i + 1] - first[i] == 1 and first[j + 1] - first[j] == 1:
        way = subtract((result[5], result[6], result[7]), (result[2], result[3], result[4]))
        length = sqrt(dot(way, way))
        if length > 0.0:
            axis[0], axis[1], axis[2] = way[0] / length, way[1] / length, way[2] / length


@compiled(counted=False)
def _check_posture(
    body: BodyArrays,
    placed: PlacedArrays,
    q: Array,
    turn: Array,
    margins: Array,
    pairs: Indices,
    left: Indices,
    worst: Array,
) -> tuple[int, int]:
    """Look at one posture.

    Args:
        body: The solids.
        placed: Scratch memory.
        q: Joint positions, (n,).
        turn: How far the axes may move from there, (n,), rad (m).
        margins: Distance that each pair is to keep, (p,) m.
        pairs: Those to check.
        left: Gets the pairs that are not proven to be free within `turn`.
        worst: Gets the largest approach of the pairs that are left, (1,) m.

    Returns:
        The first pair that is closer than its margin, or FREE; and how many pairs are left.
    """
    place(body, placed, q)
    forget_approaches(placed)
    solids, first, second = body[0], body[4], body[5]
    R, t, axes, result = placed[2], placed[3], placed[5], placed[8]
    first_part = solids[1]
    count = 0
    worst[0] = 0.0
    for p in pairs:
        i, j = first[p], second[p]
        moved = approach(body, placed, turn, i, j)
        enough = margins[p] + moved
        lower = broad_distance(body, placed, i, j, enough)
        if lower > enough:
            continue
        x, y, z = axes[p]
        if x * x + y * y + z * z > 0.0:
            between = -box_reach(solids, R, t, j, (-x, -y, -z)) - box_reach(solids, R, t, i, (x, y, z))
            if between > enough or gap_along(solids[0], R, t, first_part[i], first_part[j], x, y, z) > enough:
                continue
        if lower > margins[p] and moved > FINEST:
            # Bounds on the halves of the interval cost less than the distance.
            left[count] = p
            count += 1
            worst[0] = max(worst[0], moved)
            continue
        solid_distance(solids, R, t, i, j, (margins[p], enough, True), result)
        if result[0] <= margins[p]:
            return p, count
        _keep_direction(solids, i, j, result, axes[p])
        if result[0] <= enough:
            left[count] = p
            count += 1
            worst[0] = max(worst[0], moved)
    return FREE, count


@compiled()
def certify(
    body: BodyArrays,
    placed: PlacedArrays,
    coefficients: Array,
    speed: Array,
    margins: Array,
    work: Indices,
) -> tuple[int, float]:
    """Whether a piece of a path keeps all margins.

    Args:
        body: The solids.
        placed: Scratch memory.
        coefficients: Of the piece in powers of s, (m, n); s is in [0, 1].
        speed: Bounds on the axes' derivatives with respect to s, (n,).
        margins: (p,) m.
        work: (1,), to which the number of postures that were checked is added.

    Returns:
        FREE, or the first pair that was found too close, or not proven to be free; and s there.
    """
    n, every = coefficients.shape[1], np.arange(margins.size)
    q, turn, worst = np.empty(n), np.empty(n), np.empty(1)
    left = np.empty(margins.size, dtype=np.int64)
    # Intervals of one level: their starts, and the parts of `pairs` that are open there.
    lows, begins, counts = np.zeros(1), np.zeros(1, dtype=np.int64), np.full(1, margins.size, dtype=np.int64)
    pairs, width = every, 1.0
    placed[5][:] = 0.0
    while lows.size > 0:
        next_lows, next_begins = np.empty(2 * lows.size), np.empty(2 * lows.size, dtype=np.int64)
        next_counts = np.empty(2 * lows.size, dtype=np.int64)
        total = 0
        for k in range(lows.size):
            total += counts[k]
        kept = np.empty(total, dtype=np.int64)
        intervals = filled = 0
        turn[:] = 0.5 * width * speed
        for k in range(lows.size):
            s = lows[k] + 0.5 * width
            _evaluate(coefficients, s, q)
            work[0] += 1
            blocked, count = _check_posture(
                body, placed, q, turn, margins, pairs[begins[k] : begins[k] + counts[k]], left, worst
            )
            if blocked != FREE:
                return blocked, s
            if count == 0:
                continue
            if worst[0] <= FINEST:
                return left[0], s
            kept[filled : filled + count] = left[:count]
            for half in range(2):
                next_lows[intervals] = lows[k] + 0.5 * half * width
                next_begins[intervals], next_counts[intervals] = filled, count
                intervals += 1
            filled += count
        lows, begins, counts = next_lows[:intervals], next_begins[:intervals], next_counts[:intervals]
        pairs, width = kept, 0.5 * width
    return FREE, 0.0


@compiled(counted=False)
def _evaluate(coefficients: Array, s: float, q: Array) -> None:
    """Fill q (n,) with a polynomial's value."""
    for axis in range(q.size):
        value = 0.0
        for power in range(coefficients.shape[0] - 1, -1, -1):
            value = value * s + coefficients[power, axis]
        q[axis] = value


@compiled()
def certify_line(
    body: BodyArrays, placed: PlacedArrays, start: Array, end: Array, margins: Array, work: Indices
) -> tuple[int, float]:
    """`certify` of the straight line between two postures, (n,) each."""
    coefficients = np.empty((2, start.size))
    coefficients[0] = start
    coefficients[1] = end - start
    return certify(body, placed, coefficients, np.abs(coefficients[1]), margins, work)


@compiled()
def blocking_pair(body: BodyArrays, placed: PlacedArrays, q: Array, margins: Array) -> int:
    """A pair that is closer than its margin in one posture, or FREE."""
    left, worst = np.empty(margins.size, dtype=np.int64), np.empty(1)
    blocked, count = _check_posture(
        body, placed, q, np.zeros(q.size), margins, np.arange(margins.size), left, worst
    )
    return left[0] if blocked == FREE and count > 0 else blocked
