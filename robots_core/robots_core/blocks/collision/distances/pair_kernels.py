# ruff: noqa: PLR0917  # compiled loops over arrays
"""Broad phase, distances and motion bounds of many pairs of solids, compiled."""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.collision.distances.nearest_points import Indices, PartArrays, nearest_points
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import (
    add,
    copy_into,
    dot,
    matrix_of,
    product,
    row_of,
    subtract,
    times,
    transposed,
)
from robots_core.validation import Array

SolidArrays = tuple[PartArrays, Indices, Array, Array, Array, Array, Indices, Array, Array]
"""Arrays of s solids with p parts; a convex solid has one part, a surface one per triangle.

The parts; first part of every solid (s + 1,); centres (p, 3) and radii (p,) of balls around the parts;
centres (s, 3) and half edges (s, 3) of boxes around the solids, in their own frames; the axis frame that each
is fixed to (s,), and its pose there: orientation (s, 3, 3), position (s, 3). Lengths in m.
"""
MotionArrays = tuple[Array, NDArray[np.bool_]]
"""Directions of the axes, each in its own frame, (n, 3), and whether they slide, (n,)."""


@compiled()
def place(solids: SolidArrays, r: Array, T: Array, R: Array, t: Array) -> None:
    """Fill orientations R (s, 3, 3) and positions t (s, 3) of the solids for axis frames r, T."""
    frame, local_R, local_t = solids[6], solids[7], solids[8]
    for s in range(frame.size):
        k = frame[s] - 1
        if k < 0:
            R[s], t[s] = local_R[s], local_t[s]
            continue
        turned = matrix_of(T[k])
        t[s, 0], t[s, 1], t[s, 2] = add(row_of(r, k), times(turned, row_of(local_t, s)))
        for row in range(3):
            R[s, row, 0], R[s, row, 1], R[s, row, 2] = product(turned, matrix_of(local_R[s]))[row]


@compiled()
def _ball_to_box(solids: SolidArrays, R: Array, t: Array, i: int, j: int) -> float:
    """Distance of the ball around the box of solid i from the box of solid j, m; below 0 if they overlap."""
    centres, halves = solids[4], solids[5]
    middle = add(subtract(row_of(t, i), row_of(t, j)), times(matrix_of(R[i]), row_of(centres, i)))
    inside = subtract(times(transposed(matrix_of(R[j])), middle), row_of(centres, j))
    squared = 0.0
    for axis in range(3):
        outside = abs(inside[axis]) - halves[j, axis]
        if outside > 0.0:
            squared += outside * outside
    half = row_of(halves, i)
    return sqrt(squared) - sqrt(dot(half, half))


@compiled()
def broad_distance(solids: SolidArrays, R: Array, t: Array, i: int, j: int) -> float:
    """A fast lower bound of the distance of two solids, m; may be below 0."""
    return max(_ball_to_box(solids, R, t, i, j), _ball_to_box(solids, R, t, j, i))


@compiled()
def broad_distances(solids: SolidArrays, R: Array, t: Array, first: Indices, second: Indices) -> Array:
    """`broad_distance` of many pairs, (p,)."""
    result = np.empty(first.size)
    for k in range(first.size):
        result[k] = broad_distance(solids, R, t, first[k], second[k])
    return result


@compiled(counted=False)
def solid_distance(
    solids: SolidArrays,
    R: Array,
    t: Array,
    i: int,
    j: int,
    near: float,
    enough: float,
    between: bool,  # noqa: FBT001
    result: Array,
) -> None:
    """Fill result (8,) as `nearest_points` does, for solids of any kind.

    Surfaces are not filled: a solid inside of one has a distance from it. A lower bound beyond `enough` (m)
    may be less than the distance, and the points are then not the nearest ones. The same holds for a distance
    of at most `near` (m) and, with `between`, for one between both.
    """
    first = solids[1]
    if first[i + 1] - first[i] == 1 and first[j + 1] - first[j] == 1:
        nearest_points(solids[0], R, t, first[i], first[j], near, enough, between, result)
    else:
        _surface_distance(solids, R, t, i, j, near, enough, between, result)


@compiled()
def _surface_distance(
    solids: SolidArrays,
    R: Array,
    t: Array,
    i: int,
    j: int,
    near: float,
    enough: float,
    between: bool,  # noqa: FBT001
    result: Array,
) -> None:
    """`solid_distance`, of which at least one solid is a surface."""
    parts, first, centres, radii = solids[0], solids[1], solids[2], solids[3]
    one = np.empty(8)
    R_i, R_j = matrix_of(R[i]), matrix_of(R[j])
    balls = np.empty((first[j + 1] - first[j], 3))
    for b in range(first[j], first[j + 1]):
        k = b - first[j]
        balls[k, 0], balls[k, 1], balls[k, 2] = add(row_of(t, j), times(R_j, row_of(centres, b)))
    result[:] = 0.0
    result[0] = result[1] = inf
    for a in range(first[i], first[i + 1]):
        ball = add(row_of(t, i), times(R_i, row_of(centres, a)))
        for b in range(first[j], first[j + 1]):
            way = subtract(ball, row_of(balls, b - first[j]))
            apart = sqrt(dot(way, way)) - radii[a] - radii[b]
            if apart > result[1] or apart > enough:
                result[0] = min(result[0], apart)
                continue
            nearest_points(parts, R, t, a, b, near, min(enough, result[1]), between, one)
            result[0] = min(result[0], one[0])
            if one[1] < result[1]:
                copy_into(result[1:], one[1:])


@compiled()
def distances(
    solids: SolidArrays, R: Array, t: Array, first: Indices, second: Indices, enough: Array
) -> Array:
    """Proven lower bounds of the distances of many pairs, (p,) m; exact up to `enough` (p,)."""
    bounds = np.empty(first.size)
    result = np.empty(8)
    for k in range(first.size):
        bounds[k] = broad_distance(solids, R, t, first[k], second[k])
        if bounds[k] <= enough[k]:
            solid_distance(solids, R, t, first[k], second[k], 0.0, enough[k], False, result)
            bounds[k] = result[0]
    return bounds


@compiled()
def smallest_distance(
    solids: SolidArrays, R: Array, t: Array, first: Indices, second: Indices, limit: float
) -> tuple[float, int]:
    """Smallest distance (m) of many pairs, and which it is; `limit` and -1 if none is below it."""
    bounds = broad_distances(solids, R, t, first, second)
    result = np.empty(8)
    best, at = limit, -1
    # The smallest bound first, until all others are farther; few steps, so that sorting would not pay.
    while bounds.size > 0:
        k = int(np.argmin(bounds))
        if bounds[k] >= best:
            break
        bounds[k] = np.inf
        solid_distance(solids, R, t, first[k], second[k], 0.0, best, False, result)
        if result[1] < best:
            best, at = result[1], k
    return best, at


@compiled()
def travels(
    solids: SolidArrays,
    motion: MotionArrays,
    r: Array,
    T: Array,
    R: Array,
    t: Array,
    first: Indices,
    second: Indices,
    turn: Array,
) -> Array:
    """Upper bound on the approach of two solids while the axes move, (p,) m.

    Moved one after the other, the outermost axis first, axis k moves a point by no more than its turn times
    the point's distance from the axis: that at the current joint positions, plus the displacement by the axes
    further out (after Schwarzer, Saha and Latombe 2005, with current radii in place of the largest ones).

    Args:
        solids: The solids.
        motion: The axes.
        r: Origins of the axis frames at the current joint positions, (n, 3), m.
        T: Their orientations, (n, 3, 3).
        R: Orientations of the solids, (s, 3, 3).
        t: Positions of the solids, (s, 3), m.
        first: First solid of each pair, fixed to a frame not after that of the other.
        second: Other solid of each pair.
        turn: Largest displacement of each axis from its current position, (n,), rad (m).
    """
    directions, slides = motion
    centres, halves, frame = solids[4], solids[5], solids[6]
    n = turn.size
    # Distance of the farthest corner of a solid's box from each axis, computed on demand.
    reach = np.full((frame.size, n), -1.0)
    result = np.zeros(first.size)
    for p in range(first.size):
        s = second[p]
        approach = 0.0
        for k in range(frame[s] - 1, frame[first[p]] - 1, -1):
            if slides[k]:
                approach += turn[k]
                continue
            if reach[s, k] < 0.0:
                farthest = 0.0
                axis = times(matrix_of(T[k]), row_of(directions, k))
                for corner in range(8):
                    x, y, z = halves[s, 0], halves[s, 1], halves[s, 2]
                    side = (x if corner & 1 else -x, y if corner & 2 else -y, z if corner & 4 else -z)
                    at = times(matrix_of(R[s]), add(row_of(centres, s), side))
                    arm = add(subtract(row_of(t, s), row_of(r, k)), at)
                    farthest = max(farthest, dot(arm, arm) - dot(arm, axis) ** 2)
                reach[s, k] = sqrt(farthest)
            approach += turn[k] * (reach[s, k] + approach)
        result[p] = approach
    return result
