"""CollisionEngine: contacts of solids by a collision library, python-fcl or coal."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import coal
import fcl
import numpy as np

from robots_core.blocks.collision.solids import Solid
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Mesh, Sphere
from robots_core.validation import Array


class CollisionEngine(ABC):
    """A set of solids, identified by their index, as objects of a library.

    The libraries have one origin, and share names; subclasses have what differs.
    """

    library: ClassVar[Any]

    def __init__(self, solids: Sequence[Solid]) -> None:
        self._solids = solids
        self._objects: list[Any] = [None] * len(solids)
        self._request = self.library.CollisionRequest()
        self._placed = [-1] * len(solids)
        self._placement = 0
        self._R: Array
        self._t: Array

    def place(self, R: Array, t: Array) -> None:
        """Place all solids: orientations (s, 3, 3) and positions (s, 3), m."""
        self._R, self._t = R, t
        self._placement += 1

    def in_contact(self, first: int, second: int) -> bool:
        """Whether two solids touch or overlap."""
        result = self.library.CollisionResult()
        return bool(self.library.collide(self._object(first), self._object(second), self._request, result))

    def _object(self, index: int) -> Any:
        # Solids are built and moved on demand: most pairs are excluded by the broad phase.
        found = self._objects[index]
        if found is None:
            found = self._objects[index] = self.library.CollisionObject(self.geometry(self._solids[index]))
        if self._placed[index] != self._placement:
            self._placed[index] = self._placement
            found.setRotation(self._R[index])
            found.setTranslation(self._t[index])
        return found

    @classmethod
    def geometry(cls, solid: Solid) -> Any:
        """A solid as the library has it."""
        match solid.geometry:
            case Box(size):
                return cls.library.Box(*size)
            case Cylinder(radius, length):
                return cls.library.Cylinder(radius, length)
            case Capsule(radius, length):
                return cls.library.Capsule(radius, length)
            case Sphere(radius):
                return cls.library.Sphere(radius)
            case mesh:
                return cls.hull(mesh) if solid.convex else cls.surface(mesh)

    @staticmethod
    @abstractmethod
    def hull(mesh: Mesh) -> Any:
        """A mesh that is convex."""

    @staticmethod
    @abstractmethod
    def surface(mesh: Mesh) -> Any:
        """Any other mesh."""


class FclEngine(CollisionEngine):
    """python-fcl, pair by pair: its broad-phase manager calls back into Python for each, which is slower."""

    library = fcl

    @staticmethod
    def hull(mesh: Mesh) -> Any:
        """See `CollisionEngine.hull`; a face is its number of corners, then their indices."""
        return fcl.Convex(mesh.vertices, len(mesh.faces), np.insert(mesh.faces, 0, 3, axis=1).ravel())

    @staticmethod
    def surface(mesh: Mesh) -> Any:
        """See `CollisionEngine.surface`."""
        model = fcl.BVHModel()
        model.beginModel(len(mesh.faces), len(mesh.vertices))
        model.addSubModel(mesh.vertices, mesh.faces)
        model.endModel()
        return model


class CoalEngine(CollisionEngine):
    """coal (the successor of hpp-fcl; Montaut et al. 2024), which comes with Pinocchio, pair by pair."""

    library = coal

    @staticmethod
    def hull(mesh: Mesh) -> Any:
        """See `CollisionEngine.hull`."""
        return coal.Convex.convexHull(_points(mesh.vertices), True, 'Qt')

    @staticmethod
    def surface(mesh: Mesh) -> Any:
        """See `CollisionEngine.surface`."""
        triangles = coal.StdVec_Triangle()
        for face in mesh.faces:
            triangles.append(coal.Triangle(*map(int, face)))
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(mesh.faces), len(mesh.vertices))
        model.addSubModel(_points(mesh.vertices), triangles)
        model.endModel()
        return model


def _points(vertices: Array) -> coal.StdVec_Vec3s:
    points = coal.StdVec_Vec3s()
    for vertex in vertices:
        points.append(vertex)
    return points
