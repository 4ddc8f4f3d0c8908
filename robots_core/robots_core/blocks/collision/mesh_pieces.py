"""Pieces of triangle meshes. It loads trimesh, which takes longer than all that is computed here."""

import numpy as np
import trimesh
from numpy.typing import NDArray

from robots_core.blocks.collision.solids import FLAT, HULL_EXCESS
from robots_core.robot_model.shapes import Mesh


def pieces_of(mesh: Mesh) -> list[tuple[Mesh, bool]]:
    """The connected pieces of a mesh, each with whether it is convex; a convex one as its hull."""
    whole = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    whole.update_faces(whole.nondegenerate_faces())
    pieces = trimesh.graph.connected_components(
        whole.face_adjacency, nodes=np.arange(len(whole.faces)), engine='scipy'
    )
    return [_piece(whole, faces) for faces in pieces]


def is_closed(mesh: Mesh) -> bool:
    """The surface encloses a volume."""
    return bool(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).is_watertight)


def _piece(mesh: trimesh.Trimesh, chosen: NDArray[np.int64]) -> tuple[Mesh, bool]:
    used, faces = np.unique(mesh.faces[chosen], return_inverse=True)
    surface = Mesh(mesh.vertices[used], faces.reshape(-1, 3))
    piece = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    spread = np.linalg.svd(surface.vertices - surface.vertices.mean(axis=0), compute_uv=False)
    if piece.is_watertight and spread.min() > FLAT * spread.max():
        hull = trimesh.convex.convex_hull(piece)
        if abs(piece.volume) >= (1.0 - HULL_EXCESS) * hull.volume:
            return Mesh(np.asarray(hull.vertices), np.asarray(hull.faces)), True
    return surface, False
