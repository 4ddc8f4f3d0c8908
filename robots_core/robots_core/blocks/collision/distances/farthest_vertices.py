"""The few vertices of a convex part that may be farthest in a direction.

Directions are sorted into cells on the faces of a cube. Within a cell a vertex is never the farthest if
another one is farther in the directions of all four corners: the directions between are their sums. The cell
of a direction is `cell_of` of `nearest_points`.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_core.validation import Array

Indices = NDArray[np.int64]

EDGE: Final = 4  # cells along an edge of the cube
CELLS: Final = 6 * EDGE * EDGE
MANY: Final = 24  # vertices; all of fewer are compared as fast
ROUNDING: Final = 1e-9  # of the largest coordinate, by which a vertex must be farther


def _corners() -> Array:
    """Directions of the corners of all cells, (CELLS, 4, 3)."""
    lines = np.linspace(-1.0, 1.0, EDGE + 1)
    corners = np.empty((6, EDGE, EDGE, 4, 3))
    for face in range(6):
        axis, sign = face // 2, 1.0 - 2.0 * (face % 2)
        for k, (down, right) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1))):
            u, v = np.meshgrid(lines[down : EDGE + down], lines[right : EDGE + right], indexing='ij')
            corners[face, :, :, k, axis] = sign
            corners[face, :, :, k, (axis + 1) % 3] = u
            corners[face, :, :, k, (axis + 2) % 3] = v
    return corners.reshape(CELLS, 4, 3)


_CORNERS: Final = _corners()


def farthest_vertices(vertices: Array) -> tuple[Indices, Indices]:
    """The vertices of each cell, of which one is the farthest in any of its directions.

    Args:
        vertices: Of a part, (k, 3), m.

    Returns:
        The place of the first of each cell, (CELLS + 1,), in the second array: indices of vertices, which
        ascend within a cell.
    """
    along = _CORNERS @ vertices.T
    most = np.concatenate([along, along.sum(axis=1, keepdims=True)], axis=1).argmax(axis=2)
    farther = np.take_along_axis(along[:, None], most[:, :, None, None], axis=3)
    beyond = farther > along[:, None] + ROUNDING * np.abs(vertices).max()
    cells, chosen = np.nonzero(~beyond.all(axis=2).any(axis=1))
    return np.searchsorted(cells, np.arange(CELLS + 1)).astype(np.int64), chosen.astype(np.int64)
