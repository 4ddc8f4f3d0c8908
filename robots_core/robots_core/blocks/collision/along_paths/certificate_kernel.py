# ruff: noqa: PLR0917, C901  # compiled loops over arrays
"""Certificates that pieces of paths are free between their samples, compiled.

The method is that of `path_search`, on polynomials over [0, 1] in place of timed paths: an interval is free
if every pair of solids is farther apart in its middle than it can approach within the interval (Schwarzer,
Saha and Latombe 2005). Intervals are halved level by level, so that a piece that collides is left early.
"""

from math import sqrt

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import gap_along
from robots_core.blocks.collision.distances.pair_kernels import (
    Indices,
    SolidArrays,
    solid_distance,
)
from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, next_frame
from robots_core.kernels.vectors import Vector, add, dot, matrix_of, product, row_of, subtract, times
from robots_core.validation import Array

ReachArrays = tuple[Array, Array]
"""Eight points whose hull, grown by a radius, holds a solid, in its frame, (s, 8, 3) m; the radii (s,)."""
BallArrays = tuple[Indices, Array, Array]
"""The solids that axes move; of all solids, centres (s, 3) of balls around them, which lie in the solids, in
their own frames, and radii (s,), m."""
BodyArrays = tuple[SolidArrays, ChainArrays, ReachArrays, BallArrays, Indices, Indices]
"""The solids, fixed to the frames of the chain; the chain; how far the solids reach; balls around them; the
first solid of every pair, (p,), which is not moved by more axes than the second; the second."""
PlacedArrays = tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array]
"""Origins (n, 3) and orientations (n, 3, 3) of the axes' frames, z along the axis; orientations (s, 3, 3) and
positions (s, 3) of the solids, those at rest filled in; the approach of each solid by the axes from one on,
(s, n), m; the direction that separated every pair last, (p, 3), 0 for none; centres (s, 3) of the balls
around the solids, m; the points that hold one solid, (8, 3) m; a result of `solid_distance`, (8,)."""

FINEST = 1e-4  # m of approach; a piece that is not proven to be free with less counts as blocked
FREE = -1  # in place of a pair


@compiled(counted=False)
def place_solids(body: BodyArrays, placed: PlacedArrays, q: Array) -> None:
    """Place the frames and the moved solids at joint positions `q`, (n,)."""
    solids, chain = body[0], body[1]
    r, T, solid_R, solid_t, centres = placed[0], placed[1], placed[2], placed[3], placed[6]
    R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
    for i in range(q.size):
        _, R, t = next_frame(chain, i, q[i], R, t)
        r[i, 0], r[i, 1], r[i, 2] = t
        for row in range(3):
            T[i, row, 0], T[i, row, 1], T[i, row, 2] = R[row]
    for s in body[3][0]:
        k = solids[6][s] - 1
        turned = matrix_of(T[k])
        solid_t[s, 0], solid_t[s, 1], solid_t[s, 2] = add(row_of(r, k), times(turned, row_of(solids[8], s)))
        rows = product(turned, matrix_of(solids[7][s]))
        for row in range(3):
            solid_R[s, row, 0], solid_R[s, row, 1], solid_R[s, row, 2] = rows[row]
        centres[s, 0], centres[s, 1], centres[s, 2] = add(
            row_of(solid_t, s), times(rows, row_of(body[3][1], s))
        )


@compiled(counted=False)
def _approaches(body: BodyArrays, placed: PlacedArrays, turn: Array, s: int) -> None:
    """Fill how far solid s may move if axes turn by up to `turn`, (n,), from each axis on; see `travels`."""
    chain, (points, radii) = body[1], body[2]
    r, T, R, t, approaches = placed[:5]
    corners, turned, at = placed[7], matrix_of(R[s]), row_of(t, s)
    approach, filled = 0.0, False
    for k in range(body[0][6][s] - 1, -1, -1):
        if chain[k, 12] != 0.0:
            approach += turn[k]
        elif turn[k] > 0.0:
            axis, origin = (T[k, 0, 2], T[k, 1, 2], T[k, 2, 2]), row_of(r, k)
            if not filled:
                filled = True
                for p in range(8):
                    corners[p, 0], corners[p, 1], corners[p, 2] = add(at, times(turned, row_of(points[s], p)))
            farthest = 0.0
            for p in range(8):
                arm = subtract(row_of(corners, p), origin)
                farthest = max(farthest, dot(arm, arm) - dot(arm, axis) ** 2)
            approach += turn[k] * (sqrt(farthest) + radii[s] + approach)
        approaches[s, k] = approach


@compiled(counted=False)
def _outside(R: Array, t: Array, boxes: Array, halves: Array, s: int, point: Vector) -> float:
    """Distance of a point from the box around solid s, m; 0 inside."""
    x, y, z = point[0] - t[s, 0], point[1] - t[s, 1], point[2] - t[s, 2]
    squared = 0.0
    for axis in range(3):
        inside = R[s, 0, axis] * x + R[s, 1, axis] * y + R[s, 2, axis] * z - boxes[s, axis]
        outside = abs(inside) - halves[s, axis]
        if outside > 0.0:
            squared += outside * outside
    return sqrt(squared)


@compiled(counted=False)
def _gap_of_boxes(R: Array, t: Array, boxes: Array, halves: Array, i: int, j: int, axis: Vector) -> float:
    """Distance of the boxes around solids i and j along a unit vector, from i to j, m; see `gap_along`."""
    gap = 0.0
    for s, sign in ((j, 1.0), (i, -1.0)):
        gap += sign * dot(row_of(t, s), axis)
        for k in range(3):
            along = R[s, 0, k] * axis[0] + R[s, 1, k] * axis[1] + R[s, 2, k] * axis[2]
            gap += sign * boxes[s, k] * along - halves[s, k] * abs(along)
    return gap


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
    place_solids(body, placed, q)
    solids, first, second = body[0], body[4], body[5]
    R, t, approaches, axes, result = placed[2], placed[3], placed[4], placed[5], placed[8]
    parts, first_part = solids[0], solids[1]
    for s in body[3][0]:
        approaches[s, 0] = -1.0
    centres, balls, boxes, halves, frames = placed[6], body[3][2], solids[4], solids[5], solids[6]
    count = 0
    worst[0] = 0.0
    for p in pairs:
        i, j = first[p], second[p]
        if approaches[j, 0] < 0.0:
            _approaches(body, placed, turn, j)
        approach = approaches[j, frames[i]]
        enough = margins[p] + approach
        dx = centres[i, 0] - centres[j, 0]
        dy = centres[i, 1] - centres[j, 1]
        dz = centres[i, 2] - centres[j, 2]
        lower = sqrt(dx * dx + dy * dy + dz * dz) - balls[i] - balls[j]
        if lower > enough:
            continue
        lower = max(lower, _outside(R, t, boxes, halves, i, row_of(centres, j)) - balls[j])
        if lower > enough:
            continue
        lower = max(lower, _outside(R, t, boxes, halves, j, row_of(centres, i)) - balls[i])
        if lower > enough:
            continue
        x, y, z = axes[p]
        if x * x + y * y + z * z > 0.0:
            a, b = first_part[i], first_part[j]
            if (
                _gap_of_boxes(R, t, boxes, halves, i, j, (x, y, z)) > enough
                or gap_along(parts, R, t, a, b, x, y, z) > enough
            ):
                continue
        if lower > margins[p] and approach > FINEST:
            # Bounds on the halves of the interval cost less than the distance.
            left[count] = p
            count += 1
            worst[0] = max(worst[0], approach)
            continue
        solid_distance(solids, R, t, i, j, margins[p], enough, True, result)
        if result[0] <= margins[p]:
            return p, count
        _keep_direction(solids, i, j, result, axes[p])
        if result[0] <= enough:
            left[count] = p
            count += 1
            worst[0] = max(worst[0], approach)
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
