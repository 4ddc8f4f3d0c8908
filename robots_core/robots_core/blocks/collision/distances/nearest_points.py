# ruff: noqa: PLR0917, PLR0912, PLR0915, C901  # compiled loops over arrays
"""Nearest points of two convex parts with a proven lower bound of the distance, compiled.

Gilbert, Johnson and Keerthi 1988: the distance of two convex sets is that of the origin from their Minkowski
difference. Every support point bounds the distance from below, every point of the difference from above;
where both bounds meet the distance is proven. The subalgorithm checks all faces of the simplex, which is the
backup procedure of that paper and does not depend on the order of its points.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import (
    Vector,
    add,
    copy_into,
    cross,
    dot,
    matrix_of,
    row_of,
    scale,
    subtract,
    times,
    transposed,
)
from robots_core.validation import Array

Indices = NDArray[np.int64]
PartArrays = tuple[Array, Indices, Array, Array, Array, Indices]
"""Vertices (k, 3), first vertex of every part (p + 1,), disc, half length and rounding radius (p,), m, and
the frame that each part is fixed to (p,).

A part is the hull of its vertices, or, where `disc` is above 0, a cylinder along z; either grown by `radius`.
"""

Wanted = tuple[float, float, bool]
"""Distances that need not be exact: up to the first number (m, from 0), above the second (m), and, with the
third, between both. The search then ends early, as soon as that is sure; the value is above the distance, and
the points are not the nearest."""

# Differences of coordinates of some metres are rounded to 1e-15 m; the computation on simplices flatter than
# 1e-7 m is dominated by rounding, so that no bound gets tighter than this.
GAP = 1e-8  # m
MAX_STEPS = 100
SINGULAR = 1e-13  # of the product of the edges; a simplex this flat is skipped in favour of its faces


@compiled(counted=False)
def support(parts: PartArrays, R: Array, t: Array, index: int, x: float, y: float, z: float) -> Vector:
    """The point of a part, without its rounding, that is farthest along (x, y, z)."""
    vertices, first, disc, half, _, frame = parts
    at_frame = frame[index]
    T = matrix_of(R[at_frame])
    u, v, w = times(transposed(T), (x, y, z))
    if disc[index] > 0.0:
        across = sqrt(u * u + v * v)
        factor = disc[index] / across if across > 0.0 else 0.0
        a, b, c = factor * u, factor * v, half[index] if w >= 0.0 else -half[index]
    else:
        best, at = -np.inf, first[index]
        for k in range(first[index], first[index + 1]):
            along = vertices[k, 0] * u + vertices[k, 1] * v + vertices[k, 2] * w
            if along > best:
                best, at = along, k
        a, b, c = vertices[at, 0], vertices[at, 1], vertices[at, 2]
    return add(row_of(t, at_frame), times(T, (a, b, c)))


@compiled(counted=False)
def gap_along(parts: PartArrays, R: Array, t: Array, i: int, j: int, x: float, y: float, z: float) -> float:
    """Distance of two parts along the unit vector (x, y, z), from i to j, m: a bound on theirs from below."""
    first = dot(support(parts, R, t, i, x, y, z), (x, y, z))
    gap: float = dot(support(parts, R, t, j, -x, -y, -z), (x, y, z)) - first - parts[4][i] - parts[4][j]
    return gap


@compiled(counted=False)
def _weighted(weights: Array, points: Array, count: int) -> Vector:
    """Sum of the first `count` points with their weights."""
    total = (0.0, 0.0, 0.0)
    for k in range(count):
        total = add(total, scale(weights[k], row_of(points, k)))
    return total


@compiled(counted=False)
def _closest(W: Array, count: int, weights: Array, trial: Array) -> float:
    """Weights (4,) of the point of a simplex that is closest to the origin; returns its squared norm."""
    best = np.inf
    for mask in range(1, 1 << count):
        # The chosen points, at most four: o, a, b, c.
        size, o, a, b, c = 0, 0, 0, 0, 0
        for k in range(count):
            if mask >> k & 1:
                if size == 0:
                    o = k
                elif size == 1:
                    a = k
                elif size == 2:
                    b = k
                else:
                    c = k
                size += 1
        w = row_of(W, o)
        # Normal equations G mu = -E w, solved by Cramer's rule: at most three unknowns.
        m0, m1, m2 = 0.0, 0.0, 0.0
        if size > 1:
            first = subtract(row_of(W, a), w)
            g00, h0 = dot(first, first), -dot(first, w)
            if g00 <= 0.0:
                continue
            m0 = h0 / g00
        if size > 2:
            second = subtract(row_of(W, b), w)
            g01, g11, h1 = dot(first, second), dot(second, second), -dot(second, w)
            det = g00 * g11 - g01 * g01
            if size == 3:
                if det <= SINGULAR * (g00 * g11):
                    continue
                m0, m1 = (h0 * g11 - h1 * g01) / det, (g00 * h1 - g01 * h0) / det
        if size > 3:
            third = subtract(row_of(W, c), w)
            g02, g12, g22, h2 = dot(first, third), dot(second, third), dot(third, third), -dot(third, w)
            h = (h0, h1, h2)
            G = ((g00, g01, g02), (g01, g11, g12), (g02, g12, g22))
            c0, c1, c2 = cross(G[1], G[2]), cross(G[2], G[0]), cross(G[0], G[1])
            det = dot(G[0], c0)
            if det <= SINGULAR * (g00 * g11 * g22):
                continue
            m0, m1, m2 = dot(c0, h) / det, dot(c1, h) / det, dot(c2, h) / det
        if m0 < 0.0 or m1 < 0.0 or m2 < 0.0 or m0 + m1 + m2 > 1.0:
            continue
        trial[:] = 0.0
        trial[o] = 1.0 - m0 - m1 - m2
        if size > 1:
            trial[a] = m0
        if size > 2:
            trial[b] = m1
        if size > 3:
            trial[c] = m2
        point = _weighted(trial, W, count)
        norm = dot(point, point)
        if norm < best:
            best = norm
            copy_into(weights, trial)
    return best


@compiled(counted=False)
def _keep(points: Array, row: int, a: Vector, b: Vector) -> None:
    """Keep support points of both parts, and their difference, in rows of `points`: see `nearest_points`."""
    for axis in range(3):
        points[row, axis] = a[axis] - b[axis]
        points[4 + row, axis] = a[axis]
        points[8 + row, axis] = b[axis]


@compiled()
def nearest_points(
    parts: PartArrays, R: Array, t: Array, i: int, j: int, wanted: Wanted, result: Array
) -> None:
    """Fill result (8,): proven lower bound and value of the distance (m), nearest points on i and on j.

    Args:
        parts: All parts.
        R: Orientations of their frames, (f, 3, 3).
        t: Positions of their frames, (f, 3), m.
        i: The first part.
        j: The other one.
        wanted: How exact the distance is to be.
        result: Both distances are 0 in contact, the points then lie in both, or near it.
    """
    near, enough, between = wanted
    points, factors = np.empty((12, 3)), np.zeros((2, 4))  # few arrays: each takes as long as a support point
    W, A, B, weights, trial = points[:4], points[4:8], points[8:], factors[0], factors[1]
    x, y, z = subtract(row_of(t, parts[5][i]), row_of(t, parts[5][j]))
    if x * x + y * y + z * z == 0.0:
        x = 1.0
    count = 1
    _keep(points, 0, support(parts, R, t, i, -x, -y, -z), support(parts, R, t, j, x, y, z))
    weights[0] = 1.0
    lower = -np.inf
    upper = sqrt(W[0, 0] ** 2 + W[0, 1] ** 2 + W[0, 2] ** 2)
    rounding = parts[4][i] + parts[4][j]
    for _ in range(MAX_STEPS):
        x, y, z = _weighted(weights, W, count)
        upper = sqrt(x * x + y * y + z * z)
        if upper <= GAP:
            break
        a, b = support(parts, R, t, i, -x, -y, -z), support(parts, R, t, j, x, y, z)
        lower = max(lower, (x * (a[0] - b[0]) + y * (a[1] - b[1]) + z * (a[2] - b[2])) / upper)
        if upper - lower <= GAP or upper <= rounding + near or lower > rounding + enough:
            break
        if between and lower > rounding + near and upper <= rounding + enough:
            break
        # Keep points with positive weight, and add the new one.
        kept = 0
        for k in range(count):
            if weights[k] > 0.0:
                _keep(points, kept, row_of(A, k), row_of(B, k))
                kept += 1
        if kept == 4:
            upper = 0.0
            break
        _keep(points, kept, a, b)
        count = kept + 1
        squared = _closest(W, count, weights, trial)
        if squared >= upper * upper:  # rounding: no progress is possible
            weights[:] = 0.0
            _closest(W, kept, weights, trial)
            count = kept
            break
    result[2], result[3], result[4] = _weighted(weights, A, count)
    result[5], result[6], result[7] = _weighted(weights, B, count)
    touching = upper - rounding <= GAP
    result[0] = 0.0 if touching else max(lower - rounding, 0.0)
    result[1] = 0.0 if touching else upper - rounding
    if upper > GAP:
        for row in range(3):
            n = (result[5 + row] - result[2 + row]) / upper
            if not touching:
                result[2 + row] += parts[4][i] * n
                result[5 + row] -= parts[4][j] * n
            else:  # in contact: a point of both, in the middle of where they overlap
                depth = 0.5 * (upper + parts[4][i] - parts[4][j])
                result[2 + row] += min(max(depth, 0.0), upper) * n
                result[5 + row] = result[2 + row]
