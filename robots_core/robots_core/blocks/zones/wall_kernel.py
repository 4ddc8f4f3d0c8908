# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""How far solids are behind walls, compiled."""

from math import inf, sqrt

import numpy as np

from robots_core.blocks.collision.pair_kernels import Indices, SolidArrays
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array


@compiled()
def _behind(solids: SolidArrays, R: Array, t: Array, s: int, normal: Array, offset: float) -> float:
    """Distance of a wall from the point of a solid that is farthest along the wall's normal, m."""
    vertices, corner, disc, half, radius = (
        solids[0][0],
        solids[0][1],
        solids[0][2],
        solids[0][3],
        solids[0][4],
    )
    u, v, w, along = 0.0, 0.0, 0.0, 0.0
    for row in range(3):
        u += R[s, row, 0] * normal[row]
        v += R[s, row, 1] * normal[row]
        w += R[s, row, 2] * normal[row]
        along += t[s, row] * normal[row]
    farthest = -inf
    for p in range(solids[1][s], solids[1][s + 1]):
        if disc[p] > 0.0:
            farthest = max(farthest, disc[p] * sqrt(u * u + v * v) + half[p] * abs(w) + radius[p])
        for c in range(corner[p], corner[p + 1]):
            reach = vertices[c, 0] * u + vertices[c, 1] * v + vertices[c, 2] * w + radius[p]
            farthest = max(farthest, reach)
    return float(offset - along - farthest)


@compiled()
def _box_behind(solids: SolidArrays, R: Array, t: Array, s: int, normal: Array, offset: float) -> float:
    """`_behind` of the box around a solid."""
    centres, halves = solids[4], solids[5]
    farthest = 0.0
    for m in range(3):
        side = R[s, 0, m] * normal[0] + R[s, 1, m] * normal[1] + R[s, 2, m] * normal[2]
        farthest += centres[s, m] * side + halves[s, m] * abs(side)
    along = t[s, 0] * normal[0] + t[s, 1] * normal[1] + t[s, 2] * normal[2]
    return float(offset - along - farthest)


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
            distance = _box_behind(solids, R, t, chosen[i], normals[k], offsets[k])
            if distance <= enough[i]:
                distance = _behind(solids, R, t, chosen[i], normals[k], offsets[k])
            result[i, k] = distance
    return result
