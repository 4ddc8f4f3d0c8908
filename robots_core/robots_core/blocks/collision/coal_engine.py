"""CoalEngine: collision checks by coal, which comes with Pinocchio."""

from collections.abc import Sequence

import coal
import numpy as np

from robots_core.blocks.collision.engine import Answer, CollisionEngine
from robots_core.blocks.collision.solids import Solid
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Mesh, Sphere
from robots_core.validation import Array


class CoalEngine(CollisionEngine):
    """coal (the successor of hpp-fcl; Montaut et al. 2024), pair by pair."""

    def __init__(self, solids: Sequence[Solid]) -> None:
        super().__init__(solids)
        self._geometries = [_geometry(solid) for solid in solids]
        self._transforms = [coal.Transform3s() for _ in solids]
        self._request = coal.CollisionRequest()
        self._distance_request = coal.DistanceRequest()
        self._result, self._distance_result = coal.CollisionResult(), coal.DistanceResult()

    def in_contact(self, first: int, second: int) -> bool:
        """See `CollisionEngine.in_contact`."""
        self._result.clear()
        return bool(coal.collide(*self._placed_pair(first, second), self._request, self._result))

    def distance(self, first: int, second: int) -> Answer:
        """See `CollisionEngine.distance`."""
        result = self._distance_result
        result.clear()
        distance = coal.distance(*self._placed_pair(first, second), self._distance_request, result)
        return (
            float(distance),
            np.array(result.getNearestPoint1(), dtype=np.float64),
            np.array(result.getNearestPoint2(), dtype=np.float64),
        )

    def _placed_pair(self, first: int, second: int) -> tuple[object, object, object, object]:
        for index in (first, second):
            if self._is_stale(index):
                self._transforms[index].setRotation(self._R[index])
                self._transforms[index].setTranslation(self._t[index])
        return (
            self._geometries[first],
            self._transforms[first],
            self._geometries[second],
            self._transforms[second],
        )


def _geometry(solid: Solid) -> coal.CollisionGeometry:
    match solid.geometry:
        case Box(size):
            return coal.Box(*size)
        case Cylinder(radius, length):
            return coal.Cylinder(radius, length)
        case Capsule(radius, length):
            return coal.Capsule(radius, length)
        case Sphere(radius):
            return coal.Sphere(radius)
        case Mesh(vertices) if solid.convex:
            return coal.Convex.convexHull(_points(vertices), True, 'Qt')
        case Mesh(vertices, faces):
            triangles = coal.StdVec_Triangle()
            for face in faces:
                triangles.append(coal.Triangle(*map(int, face)))
            model = coal.BVHModelOBBRSS()
            model.beginModel(len(faces), len(vertices))
            model.addSubModel(_points(vertices), triangles)
            model.endModel()
            return model


def _points(vertices: Array) -> coal.StdVec_Vec3s:
    points = coal.StdVec_Vec3s()
    for vertex in vertices:
        points.append(vertex)
    return points
