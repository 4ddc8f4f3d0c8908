"""FclEngine: collision checks by python-fcl."""

from collections.abc import Sequence

import fcl
import numpy as np

from robots_core.blocks.collision.engine import Answer, CollisionEngine
from robots_core.blocks.collision.solids import Solid
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Mesh, Sphere


class FclEngine(CollisionEngine):
    """python-fcl, pair by pair: its broad-phase manager calls back into Python for each, which is slower."""

    def __init__(self, solids: Sequence[Solid]) -> None:
        super().__init__(solids)
        self._objects = [fcl.CollisionObject(_geometry(solid)) for solid in solids]
        self._request = fcl.CollisionRequest()
        self._distance_request = fcl.DistanceRequest(enable_nearest_points=True)

    def in_contact(self, first: int, second: int) -> bool:
        """See `CollisionEngine.in_contact`."""
        result = fcl.CollisionResult()
        return bool(fcl.collide(self._object(first), self._object(second), self._request, result))

    def distance(self, first: int, second: int) -> Answer:
        """See `CollisionEngine.distance`."""
        result = fcl.DistanceResult()
        distance = fcl.distance(self._object(first), self._object(second), self._distance_request, result)
        p, r = result.nearest_points
        return float(distance), np.asarray(p, dtype=np.float64), np.asarray(r, dtype=np.float64)

    def _object(self, index: int) -> fcl.CollisionObject:
        found = self._objects[index]
        if self._is_stale(index):
            found.setRotation(self._R[index])
            found.setTranslation(self._t[index])
        return found


def _geometry(solid: Solid) -> fcl.CollisionGeometry:
    match solid.geometry:
        case Box(size):
            return fcl.Box(*size)
        case Cylinder(radius, length):
            return fcl.Cylinder(radius, length)
        case Capsule(radius, length):
            return fcl.Capsule(radius, length)
        case Sphere(radius):
            return fcl.Sphere(radius)
        case Mesh(vertices, faces) if solid.convex:
            # A face is its number of corners, then their indices.
            polygons = np.insert(faces, 0, 3, axis=1).ravel()
            return fcl.Convex(vertices, len(faces), polygons)
        case Mesh(vertices, faces):
            model = fcl.BVHModel()
            model.beginModel(len(faces), len(vertices))
            model.addSubModel(vertices, faces)
            model.endModel()
            return model
