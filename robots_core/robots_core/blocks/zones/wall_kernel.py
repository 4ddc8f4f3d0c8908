# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""How far solids are behind walls, compiled."""

from math import inf, sqrt

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.blocks.collision.distances.placed_solids import SolidArrays
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import dot, matrix_of, row_of, times, transposed
from robots_core.validation import Array


@compiled()
def _behind(solids: SolidArrays, R: Array, t: Array, s: int, normals: Array, offsets: Array, k: int) -> float:
    """Distance of wall k from the point of a solid that is farthest along the wall's normal, m."""
    vertices, corner, disc, half, radius = solids[0][:5]
    wall = row_of(normals, k)
    u, v, w = times(transposed(matrix_of(R[s])), wall)
    farthest = -inf
    for p in range(solids[1][s], solids[1][s + 1]):
        if disc[p] > 0.0:
            farthest = max(farthest, disc[p] * sqrt(u * u + v * v) + half[p] * abs(w) + radius[p])
        for c in range(corner[p], corner[p + 1]):
            farthest = max(farthest, dot(row_of(vertices, c), (u, v, w)) + radius[p])
    return float(offsets[k] - dot(row_of(t, s), wall) - farthest)


@compiled()
def _box_behind(
    solids: SolidArrays, R: Array, t: Array, s: int, normals: Array, offsets: Array, k: int
) -> float:
    """`_behind` of the box around a solid."""
    centres, halves = solids[4], solids[5]
    wall = row_of(normals, k)
    u, v, w = times(transposed(matrix_of(R[s])), wall)
    farthest = dot(row_of(centres, s), (u, v, w)) + dot(row_of(halves, s), (abs(u), abs(v), abs(w)))
    return float(offsets[k] - dot(row_of(t, s), wall) - farthest)


@compiled()
def wall_distances(
    solids: SolidArrays, R: Array, t: Array, chosen: Indices, normals: Array, offsets: Array, enough: Array
) -> Array:
    """Distances of walls from the points of solids that are farthest along their normals, (c, k) m.

    Exact up to `enough`, for solids of any kind, lower bounds beyond it; below 0 where a solid crosses one.

    Args:
        solids: The solids.
        R: Orientations of the solids, (s, 3, 3).
        t: Positions of the solids, (s, 3), m.
        chosen: Solids, (c,).
        normals: Of the walls, (k, 3), of length 1.
        offsets: Distances of the walls from the origin along their normals, (k,), m.
        enough: (c,) m.
    """
    result = np.empty((chosen.size, offsets.size))
    for i in range(chosen.size):
        for k in range(offsets.size):
            distance = _box_behind(solids, R, t, chosen[i], normals, offsets, k)
            if distance <= enough[i]:
                distance = _behind(solids, R, t, chosen[i], normals, offsets, k)
            result[i, k] = distance
    return result
