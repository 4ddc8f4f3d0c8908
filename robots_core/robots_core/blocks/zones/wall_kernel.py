# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""How far solids are behind walls, compiled."""

from math import inf

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import Indices, support
from robots_core.blocks.collision.distances.placed_solids import SolidArrays, box_reach
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import Vector, dot, row_of
from robots_core.validation import Array


@compiled(counted=False)
def _reach(solids: SolidArrays, R: Array, t: Array, s: int, axis: Vector) -> float:
    """How far a solid reaches along a unit vector, m; see `box_reach`."""
    parts, farthest = solids[0], -inf
    for p in range(solids[1][s], solids[1][s + 1]):
        point = support(parts, R, t, p, axis[0], axis[1], axis[2])
        farthest = max(farthest, dot(point, axis) + parts[4][p])
    return farthest


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
            wall = row_of(normals, k)
            result[i, k] = offsets[k] - box_reach(solids, R, t, chosen[i], wall)
            if result[i, k] <= enough[i]:
                result[i, k] = offsets[k] - _reach(solids, R, t, chosen[i], wall)
    return result
