# ruff: noqa: PLR0917  # compiled loops over arrays
"""PathCertificate: proofs that pieces of paths are free, for searches that need thousands of them, compiled.

The method is that of `path_search`, on polynomials over [0, 1] in place of timed paths: an interval is free
if every pair of solids is farther apart in its middle than it can approach within the interval (Schwarzer,
Saha and Latombe 2005). Intervals are halved level by level, so that a piece that collides is left early.
"""

from __future__ import annotations

from math import comb, sqrt
from typing import NamedTuple

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


class PathCertificate(NamedTuple):
    """Certificates of a robot in a scene, also as an argument of compiled searches.

    It shares the scratch memory of the solids, which it places elsewhere.

    Attributes:
        body: Its solids and those around it, with the pairs to keep apart.
        placed: Scratch memory.
        margins: Distance that each pair keeps, (p,) m.
        work: Number of postures that were checked, (1,).
    """

    body: BodyArrays
    placed: PlacedArrays
    margins: Array
    work: Indices

    def line(self, start: Array, end: Array) -> int:
        """The pair that blocks the straight line between two postures, (n,) rad (m) each, or FREE."""
        # Read-only arrays would be compiled for again.
        return int(certify_line(self, np.array(start), np.array(end))[0])

    def piece(self, coefficients: Array) -> int:
        """The pair that blocks a polynomial over [0, 1], in powers of s, (m, n), or FREE."""
        # The derivative lies in the hull of its control points (Bernstein form).
        degree = len(coefficients) - 2
        slopes = np.arange(1, degree + 2)[:, None] * coefficients[1:]
        control = [
            sum(comb(j, k) / comb(degree, k) * slopes[k] for k in range(j + 1)) for j in range(degree + 1)
        ]
        speed = np.abs(control).max(axis=0)
        return int(certify(self, coefficients, speed)[0])

    def posture(self, q: Array) -> int:
        """A pair that is closer than its margin at joint positions `q`, (n,), or FREE."""
        return int(blocking_pair(self, np.array(q)))


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
    certificate: PathCertificate, q: Array, turn: Array, pairs: Indices, left: Indices, worst: Array
) -> tuple[int, int]:
    """The first of some pairs that is closer than its margin in a posture, or FREE; and how many are left.

    Those are `left` that are not proven to be free if the axes move by up to `turn`, (n,) rad (m); `worst` is
    the largest approach of them, (1,) m.
    """
    body, placed, margins, _ = certificate
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
def certify(certificate: PathCertificate, coefficients: Array, speed: Array) -> tuple[int, float]:
    """Whether a piece of a path keeps all margins.

    Args:
        certificate: The solids and their margins; counts the postures that are checked.
        coefficients: Of the piece in powers of s, (m, n); s is in [0, 1].
        speed: Bounds on the axes' derivatives with respect to s, (n,).

    Returns:
        FREE, or the first pair that was found too close, or not proven to be free; and s there.
    """
    n, count = coefficients.shape[1], certificate.margins.size
    q, turn, worst = np.empty(n), np.empty(n), np.empty(1)
    left = np.empty(count, dtype=np.int64)
    # Intervals of one level: their starts, and the parts of `pairs` that are open there.
    lows, begins, counts = np.zeros(1), np.zeros(1, dtype=np.int64), np.full(1, count, dtype=np.int64)
    pairs, width = np.arange(count), 1.0
    certificate.placed[5][:] = 0.0
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
            certificate.work[0] += 1
            open_ = pairs[begins[k] : begins[k] + counts[k]]
            blocked, count = _check_posture(certificate, q, turn, open_, left, worst)
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
def certify_line(certificate: PathCertificate, start: Array, end: Array) -> tuple[int, float]:
    """`certify` of the straight line between two postures, (n,) each."""
    coefficients = np.empty((2, start.size))
    coefficients[0] = start
    coefficients[1] = end - start
    return certify(certificate, coefficients, np.abs(coefficients[1]))


@compiled()
def blocking_pair(certificate: PathCertificate, q: Array) -> int:
    """A pair that is closer than its margin in one posture, or FREE."""
    count = certificate.margins.size
    left, worst = np.empty(count, dtype=np.int64), np.empty(1)
    blocked, count = _check_posture(certificate, q, np.zeros(q.size), np.arange(count), left, worst)
    return left[0] if blocked == FREE and count > 0 else blocked
