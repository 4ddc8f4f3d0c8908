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

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

PartArrays = tuple[Array, NDArray[np.int64], Array, Array, Array, NDArray[np.int64]]
"""Vertices (k, 3), first vertex of every part (p + 1,), disc, half length and rounding radius (p,), m, and
the frame that each part is fixed to (p,).

A part is the hull of its vertices, or, where `disc` is above 0, a cylinder along z; either grown by `radius`.
"""

# Differences of coordinates of some metres are rounded to 1e-15 m; the computation on simplices flatter than
# 1e-7 m is dominated by rounding, so that no bound gets tighter than this.
GAP = 1e-8  # m
MAX_STEPS = 100
SINGULAR = 1e-13  # of the product of the edges; a simplex this flat is skipped in favour of its faces


@compiled()
def support(
    parts: PartArrays, R: Array, t: Array, index: int, x: float, y: float, z: float, p: Array
) -> None:
    """Fill p (3,) with the point of a part, without its rounding, that is farthest along (x, y, z)."""
    vertices, first, disc, half, _, frame = parts
    at_frame = frame[index]
    T = R[at_frame]
    u = T[0, 0] * x + T[1, 0] * y + T[2, 0] * z
    v = T[0, 1] * x + T[1, 1] * y + T[2, 1] * z
    w = T[0, 2] * x + T[1, 2] * y + T[2, 2] * z
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
    for row in range(3):
        p[row] = T[row, 0] * a + T[row, 1] * b + T[row, 2] * c + t[at_frame, row]


@compiled()
def _closest(W: Array, count: int, weights: Array, trial: Array) -> float:
    """Weights (4,) of the point of a simplex that is closest to the origin; returns its squared norm."""
    best = np.inf
    chosen = np.empty(4, dtype=np.int64)
    E = np.empty((3, 3))
    for mask in range(1, 1 << count):
        size = 0
        for k in range(count):
            if mask >> k & 1:
                chosen[size] = k
                size += 1
        o = chosen[0]
        edges = size - 1
        scale = 1.0
        for k in range(edges):
            length = 0.0
            for row in range(3):
                E[k, row] = W[chosen[k + 1], row] - W[o, row]
                length += E[k, row] ** 2
            scale *= length
        # Normal equations G mu = -E w0, solved by Cramer's rule: at most three unknowns.
        m0, m1, m2 = 0.0, 0.0, 0.0
        if edges > 0:
            g00 = E[0, 0] ** 2 + E[0, 1] ** 2 + E[0, 2] ** 2
            h0 = -(E[0, 0] * W[o, 0] + E[0, 1] * W[o, 1] + E[0, 2] * W[o, 2])
        if edges == 1:
            if scale <= 0.0:
                continue
            m0 = h0 / g00
        elif edges > 1:
            g01 = E[0, 0] * E[1, 0] + E[0, 1] * E[1, 1] + E[0, 2] * E[1, 2]
            g11 = E[1, 0] ** 2 + E[1, 1] ** 2 + E[1, 2] ** 2
            h1 = -(E[1, 0] * W[o, 0] + E[1, 1] * W[o, 1] + E[1, 2] * W[o, 2])
            if edges == 2:
                det = g00 * g11 - g01 * g01
                if det <= SINGULAR * scale:
                    continue
                m0, m1 = (h0 * g11 - h1 * g01) / det, (g00 * h1 - g01 * h0) / det
            else:
                g02 = E[0, 0] * E[2, 0] + E[0, 1] * E[2, 1] + E[0, 2] * E[2, 2]
                g12 = E[1, 0] * E[2, 0] + E[1, 1] * E[2, 1] + E[1, 2] * E[2, 2]
                g22 = E[2, 0] ** 2 + E[2, 1] ** 2 + E[2, 2] ** 2
                h2 = -(E[2, 0] * W[o, 0] + E[2, 1] * W[o, 1] + E[2, 2] * W[o, 2])
                c00, c01, c02 = g11 * g22 - g12 * g12, g02 * g12 - g01 * g22, g01 * g12 - g02 * g11
                det = g00 * c00 + g01 * c01 + g02 * c02
                if det <= SINGULAR * scale:
                    continue
                c11, c12, c22 = g00 * g22 - g02 * g02, g01 * g02 - g00 * g12, g00 * g11 - g01 * g01
                m0 = (c00 * h0 + c01 * h1 + c02 * h2) / det
                m1 = (c01 * h0 + c11 * h1 + c12 * h2) / det
                m2 = (c02 * h0 + c12 * h1 + c22 * h2) / det
        if m0 < 0.0 or m1 < 0.0 or m2 < 0.0 or m0 + m1 + m2 > 1.0:
            continue
        trial[:] = 0.0
        trial[o] = 1.0 - m0 - m1 - m2
        if edges > 0:
            trial[chosen[1]] = m0
        if edges > 1:
            trial[chosen[2]] = m1
        if edges > 2:
            trial[chosen[3]] = m2
        norm = 0.0
        for row in range(3):
            value = 0.0
            for k in range(count):
                value += trial[k] * W[k, row]
            norm += value * value
        if norm < best:
            best = norm
            weights[:] = trial
    return best


@compiled()
def nearest_points(parts: PartArrays, R: Array, t: Array, i: int, j: int, result: Array) -> None:
    """Fill result (8,): proven lower bound and value of the distance (m), nearest points on i and on j.

    Args:
        parts: All parts.
        R: Orientations of their frames, (f, 3, 3).
        t: Positions of their frames, (f, 3), m.
        i: The first part.
        j: The other one.
        result: Both distances are 0 in contact, the points then lie in both, or near it.
    """
    W, A, B = np.empty((4, 3)), np.empty((4, 3)), np.empty((4, 3))
    weights, trial = np.zeros(4), np.zeros(4)
    a, b = np.empty(3), np.empty(3)
    k, m = parts[5][i], parts[5][j]
    x, y, z = t[k, 0] - t[m, 0], t[k, 1] - t[m, 1], t[k, 2] - t[m, 2]
    if x * x + y * y + z * z == 0.0:
        x = 1.0
    support(parts, R, t, i, -x, -y, -z, a)
    support(parts, R, t, j, x, y, z, b)
    count = 1
    A[0], B[0], W[0] = a, b, a - b
    weights[0] = 1.0
    lower = -np.inf
    upper = sqrt(W[0, 0] ** 2 + W[0, 1] ** 2 + W[0, 2] ** 2)
    rounding = parts[4][i] + parts[4][j]
    for _ in range(MAX_STEPS):
        x, y, z = 0.0, 0.0, 0.0
        for k in range(count):
            x += weights[k] * W[k, 0]
            y += weights[k] * W[k, 1]
            z += weights[k] * W[k, 2]
        upper = sqrt(x * x + y * y + z * z)
        if upper <= GAP:
            break
        support(parts, R, t, i, -x, -y, -z, a)
        support(parts, R, t, j, x, y, z, b)
        lower = max(lower, (x * (a[0] - b[0]) + y * (a[1] - b[1]) + z * (a[2] - b[2])) / upper)
        if upper - lower <= GAP or upper <= rounding:
            break
        # Keep points with positive weight, and add the new one.
        kept = 0
        for k in range(count):
            if weights[k] > 0.0:
                A[kept], B[kept], W[kept] = A[k], B[k], W[k]
                kept += 1
        if kept == 4:
            upper = 0.0
            break
        A[kept], B[kept], W[kept] = a, b, a - b
        count = kept + 1
        squared = _closest(W, count, weights, trial)
        if squared >= upper * upper:  # rounding: no progress is possible
            weights[:] = 0.0
            _closest(W, kept, weights, trial)
            count = kept
            break
    result[2:] = 0.0
    for k in range(count):
        for row in range(3):
            result[2 + row] += weights[k] * A[k, row]
            result[5 + row] += weights[k] * B[k, row]
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


@compiled()
def lower_bound(parts: PartArrays, R: Array, t: Array, i: int, j: int, x: float, y: float, z: float) -> float:
    """Distance (m) of two parts along the unit vector (x, y, z) from i to j: the true one is not smaller."""
    a, b = np.empty(3), np.empty(3)
    support(parts, R, t, i, x, y, z, a)
    support(parts, R, t, j, -x, -y, -z, b)
    return float(x * (b[0] - a[0]) + y * (b[1] - a[1]) + z * (b[2] - a[2]) - parts[4][i] - parts[4][j])


@compiled()
def inside(parts: PartArrays, R: Array, t: Array, i: int, point: Array, tolerance: float) -> bool:
    """Whether a part holds a point (3,), or is no farther from it than the tolerance (m)."""
    vertices, first, disc, half, radius, frame = parts
    f = frame[i]
    local = np.empty(3)
    for row in range(3):
        local[row] = (
            R[f, 0, row] * (point[0] - t[f, 0])
            + R[f, 1, row] * (point[1] - t[f, 1])
            + R[f, 2, row] * (point[2] - t[f, 2])
        )
    count = first[i + 1] - first[i]
    two_vertices = np.empty((count + 1, 3))
    two_vertices[:count] = vertices[first[i] : first[i + 1]]
    two_vertices[count] = local
    two = (
        two_vertices,
        np.array([0, count, count + 1]),
        np.array([disc[i], 0.0]),
        np.array([half[i], 0.0]),
        np.array([radius[i], 0.0]),
        np.zeros(2, dtype=np.int64),
    )
    result = np.empty(8)
    nearest_points(two, np.eye(3).reshape(1, 3, 3), np.zeros((1, 3)), 0, 1, result)
    return bool(result[1] <= tolerance)


@compiled()
def proven(
    parts: PartArrays,
    R: Array,
    t: Array,
    i: int,
    j: int,
    distance: float,
    p_i: Array,
    p_j: Array,
    tolerance: float,
) -> bool:
    """Whether `distance` (m) is that of two parts with nearest points `p_i`, `p_j` (3,), to the tolerance.

    It is if the points are `distance` apart, each lies on its part, and no points of the parts are closer
    along the line through them.
    """
    x, y, z = p_j[0] - p_i[0], p_j[1] - p_i[1], p_j[2] - p_i[2]
    length = sqrt(x * x + y * y + z * z)
    if not abs(length - distance) <= tolerance or length <= tolerance:
        return False
    if not lower_bound(parts, R, t, i, j, x / length, y / length, z / length) >= distance - tolerance:
        return False
    return inside(parts, R, t, i, p_i, tolerance) and inside(parts, R, t, j, p_j, tolerance)
