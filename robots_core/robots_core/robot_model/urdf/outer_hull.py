"""OuterHull: a convex body with few corners around a mesh with many, for collision checks."""

from itertools import product
from pathlib import Path
from typing import Final

import numpy as np
import trimesh
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from robots_core.blocks.collision.solids import solids_of
from robots_core.files.content_cache import Arrays, content_of, kept
from robots_core.files.user_file import MAX_MESH, read_bytes
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Mesh
from robots_core.robot_model.urdf.mesh_file import read_mesh
from robots_core.validation import Array

# Triangles of a surface, and of a mesh of convex pieces: with more the search for distances takes minutes.
SIMPLE: Final = 100
DETAILED: Final = 1000
EXCESS: Final = 2e-3  # m, to which the hull is cut down towards the mesh
MOST_PLANES: Final = 48
MERGED: Final = 5  # decimals of a metre to which corners are rounded
SMALL_FILE: Final = 50_000  # bytes; of these nothing is kept

# Of a body whose corners and edges are cut off: 6 faces, 12 edges and 8 corners of a cube.
_DIRECTIONS: Final = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=3) if any(way)])


def read_outer_hull(path: Path, scale: ArrayLike = 1.0) -> Mesh:
    """The mesh of a file, or a convex body around it if it is detailed; see `read_mesh`.

    Raises:
        InvalidInputError: as `read_mesh`.
    """
    data = read_bytes(path, 'mesh file', largest=MAX_MESH)
    if len(data) < SMALL_FILE:
        return _simple(read_mesh(path, scale))

    def computed() -> Arrays:
        mesh = _simple(read_mesh(path, scale))
        return {'vertices': mesh.vertices, 'faces': mesh.faces}

    limits = SIMPLE, DETAILED, EXCESS, MOST_PLANES, MERGED
    content = content_of((data, path.suffix, np.asarray(scale, dtype=np.float64), limits))
    arrays = kept('outer_hull', content, computed)
    return Mesh(arrays['vertices'], arrays['faces'])


def _simple(mesh: Mesh) -> Mesh:
    """The mesh, or a convex body around it if it has more triangles than checks can do with."""
    faces = len(mesh.faces)
    if faces <= SIMPLE:
        return mesh
    pieces = solids_of('', mesh, 0, Pose(np.zeros(3), np.eye(3))) if faces <= DETAILED else ()
    return mesh if pieces and all(piece.convex for piece in pieces) else outer_hull(mesh)


def outer_hull(mesh: Mesh) -> Mesh:
    """A convex mesh that encloses a mesh; the mesh itself where that is flat.

    The planes of a discrete oriented polytope (Klosowski et al. 1998) with 26 directions come first, then the
    faces of the convex hull that cut off most, until no corner is farther than `EXCESS` outside of a face, or
    there are `MOST_PLANES`.
    """
    try:
        hull = ConvexHull(mesh.vertices)
    except QhullError:
        return mesh
    faces: Array = hull.equations
    directions = _DIRECTIONS / np.linalg.norm(_DIRECTIONS, axis=1, keepdims=True)
    offsets = (mesh.vertices @ directions.T).max(axis=0)
    planes = np.column_stack([directions, -offsets])
    inside = mesh.vertices[hull.vertices].mean(axis=0)
    while True:
        corners = HalfspaceIntersection(planes, inside).intersections
        outside = (faces[:, :3] @ corners.T + faces[:, 3:]).max(axis=1)
        worst = int(np.argmax(outside))
        if outside[worst] <= EXCESS or len(planes) >= MOST_PLANES:
            break
        planes = np.vstack([planes, faces[worst]])
    # Where more than three planes meet, their corners differ by rounding; slivers between them are no hull.
    result = trimesh.convex.convex_hull(np.unique(corners.round(MERGED), axis=0))
    return Mesh(result.vertices, result.faces)
