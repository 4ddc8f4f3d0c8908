# ruff: noqa: PLR0917  # compiled loops over arrays
"""Broad phase, distances and motion bounds of many pairs of solids, compiled."""

from math import inf, sqrt

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import Indices, Wanted, nearest_points
from robots_core.blocks.collision.distances.placed_solids import (
    BodyArrays,
    PlacedArrays,
    SolidArrays,
    approach,
    broad_distance,
    forget_approaches,
)
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import add, copy_into, dot, matrix_of, row_of, subtract, times
from robots_core.validation import Array


@compiled()
def broad_distances(body: BodyArrays, placed: PlacedArrays, enough: float) -> Array:
    """`broad_distance` of all pairs, (p,)."""
    first, second = body[4], body[5]
    result = np.empty(first.size)
    for p in range(first.size):
        result[p] = broad_distance(body, placed, first[p], second[p], enough)
    return result


@compiled(counted=False)
def solid_distance(
    solids: SolidArrays, R: Array, t: Array, i: int, j: int, wanted: Wanted, result: Array
) -> None:
    """Fill result (8,) as `nearest_points` does, for solids of any kind.

    Surfaces are not filled: a solid inside of one has a distance from it.
    """
    first = solids[1]
    if first[i + 1] - first[i] == 1 and first[j + 1] - first[j] == 1:
        nearest_points(solids[0], R, t, first[i], first[j], wanted, result)
    else:
        _surface_distance(solids, R, t, i, j, wanted, result)


@compiled()
def _surface_distance(
    solids: SolidArrays, R: Array, t: Array, i: int, j: int, wanted: Wanted, result: Array
) -> None:
    """`solid_distance`, of which at least one solid is a surface."""
    near, enough, between = wanted
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
            nearest_points(parts, R, t, a, b, (near, min(enough, result[1]), between), one)
            result[0] = min(result[0], one[0])
            if one[1] < result[1]:
                copy_into(result[1:], one[1:])


@compiled()
def distances(body: BodyArrays, placed: PlacedArrays, chosen: Indices, enough: Array) -> Array:
    """Proven lower bounds of the distances of chosen pairs, (k,) m; exact up to `enough` (k,)."""
    bounds = np.empty(chosen.size)
    R, t, result = placed[2], placed[3], placed[8]
    for k in range(chosen.size):
        i, j = body[4][chosen[k]], body[5][chosen[k]]
        bounds[k] = broad_distance(body, placed, i, j, enough[k])
        if bounds[k] <= enough[k]:
            solid_distance(body[0], R, t, i, j, (0.0, enough[k], False), result)
            bounds[k] = result[0]
    return bounds


@compiled()
def smallest_distance(
    body: BodyArrays, placed: PlacedArrays, chosen: Indices, limit: float
) -> tuple[float, int]:
    """Smallest distance (m) of chosen pairs, and which it is; `limit` and -1 if none is below it."""
    bounds = np.empty(chosen.size)
    for k in range(chosen.size):
        bounds[k] = broad_distance(body, placed, body[4][chosen[k]], body[5][chosen[k]], limit)
    R, t, result = placed[2], placed[3], placed[8]
    best, at = limit, -1
    # The smallest bound first, until all others are farther; few steps, so that sorting would not pay.
    while bounds.size > 0:
        k = int(np.argmin(bounds))
        if bounds[k] >= best:
            break
        bounds[k] = np.inf
        solid_distance(body[0], R, t, body[4][chosen[k]], body[5][chosen[k]], (0.0, best, False), result)
        if result[1] < best:
            best, at = result[1], k
    return best, at


@compiled()
def travels(body: BodyArrays, placed: PlacedArrays, chosen: Indices, turn: Array) -> Array:
    """`approach` of chosen pairs where the solids were placed, (k,) m."""
    forget_approaches(placed)
    result = np.empty(chosen.size)
    for k in range(chosen.size):
        result[k] = approach(body, placed, turn, body[4][chosen[k]], body[5][chosen[k]])
    return result
