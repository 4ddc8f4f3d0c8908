"""Solids: convex pieces and concave surfaces for collision checks."""

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from types import ModuleType

import numpy as np

from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.validation import Array, read_only

# A mesh is replaced by its convex hull if that is larger by at most this fraction: files have single
# precision.
HULL_EXCESS = 1e-4
FLAT = 1e-9  # a piece this thin, relative to its size, encloses nothing
BOX_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


@dataclass(frozen=True, eq=False)
class Solid:
    """A geometry with a name, fixed to a frame.

    Attributes:
        name: Of the shape of the robot or the object that it belongs to.
        geometry: Box, cylinder, capsule, sphere, or a mesh in one piece.
        frame: 0 for the base, i for the frame of axis i (counted from 1).
        pose: Pose in that frame.
        convex: The mesh is a convex hull; otherwise it is a surface, closed or not.
    """

    name: str
    geometry: Geometry
    frame: int
    pose: Pose
    convex: bool = True

    @cached_property
    def core(self) -> tuple[Array, float, float, float]:
        """Vertices (k, 3), disc, half length and rounding radius, m; see `PartArrays`."""
        match self.geometry:
            case Box(size):
                return read_only(BOX_CORNERS * size), 0.0, 0.0, 0.0
            case Cylinder(radius, length):
                return np.empty((0, 3)), radius, 0.5 * length, 0.0
            case Capsule(radius, length):
                ends = read_only([[0.0, 0.0, -0.5 * length], [0.0, 0.0, 0.5 * length]])
                return ends, 0.0, 0.0, radius
            case Sphere(radius):
                return np.zeros((1, 3)), 0.0, 0.0, radius
            case Mesh(vertices):
                return vertices, 0.0, 0.0, 0.0

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner in its own frame, (3,) each, m."""
        vertices, disc, half, radius = self.core
        if disc > 0.0:
            corner = np.array([disc, disc, half])
            return -corner, corner
        return vertices.min(axis=0) - radius, vertices.max(axis=0) + radius

    @cached_property
    def ball(self) -> tuple[Array, float]:
        """Centre (3,), which lies in the solid, and radius of a ball around it, in its own frame, m."""
        core, disc, half, radius = self.core
        if disc > 0.0:
            return np.zeros(3), float(np.hypot(disc, half)) + radius
        # A surface holds its points; a hull also their mean.
        centre = core.mean(axis=0) if self.convex else core[0]
        return centre, float(np.linalg.norm(core - centre, axis=1).max()) + radius

    @cached_property
    def reach(self) -> tuple[Array, float]:
        """Eight points (8, 3) whose hull, grown by a radius, holds the solid, in its own frame, m."""
        core, disc, _, radius = self.core
        if self.convex and disc == 0.0 and len(core) <= len(BOX_CORNERS):
            return np.resize(core, BOX_CORNERS.shape), radius  # fewer points are repeated
        low, high = self.bounds
        return 0.5 * (low + high) + BOX_CORNERS * (high - low), 0.0

    @cached_property
    def triangles(self) -> Array:
        """Corners of a mesh's triangles in its own frame, (f, 3, 3) m."""
        assert isinstance(self.geometry, Mesh)
        return self.geometry.vertices[self.geometry.faces]

    @cached_property
    def closed(self) -> bool:
        """The surface encloses a volume."""
        if not isinstance(self.geometry, Mesh):
            return True
        return bool(_mesh_pieces().is_closed(self.geometry))

    def encloses(self, point: Array) -> bool:
        """Whether a point (3,), in the surface's own frame, is inside a closed surface.

        By the solid angle of the surface at the point (van Oosterom and Strackee 1983).
        """
        a, b, c = np.moveaxis(self.triangles - point, 1, 0)
        la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
        volume = np.einsum('ij,ij->i', a, np.cross(b, c))
        rest = (
            la * lb * lc
            + np.einsum('ij,ij->i', a, b) * lc
            + np.einsum('ij,ij->i', b, c) * la
            + np.einsum('ij,ij->i', c, a) * lb
        )
        return bool(abs(np.arctan2(volume, rest).sum()) > np.pi)  # 2 pi inside, 0 outside


def solids_of(name: str, geometry: Geometry, frame: int, pose: Pose) -> tuple[Solid, ...]:
    """A geometry as solids: a mesh is split into its connected pieces; a convex piece becomes its hull."""
    if not isinstance(geometry, Mesh):
        return (Solid(name, geometry, frame, pose),)
    pieces: list[tuple[Mesh, bool]] = _mesh_pieces().pieces_of(geometry)
    return tuple(Solid(name, piece, frame, pose, convex) for piece, convex in pieces)


def _mesh_pieces() -> ModuleType:
    # Imported on demand: a robot whose pieces are kept, and a scene without meshes, need no trimesh.
    return import_module('robots_core.blocks.collision.mesh_pieces')
