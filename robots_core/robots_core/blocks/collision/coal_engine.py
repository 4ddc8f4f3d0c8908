"""CoalEngine: collision checks by coal, which comes with Pinocchio."""

from typing import Any

import coal

from robots_core.blocks.collision.engine import CollisionEngine
from robots_core.robot_model.shapes import Mesh
from robots_core.validation import Array


class CoalEngine(CollisionEngine):
    """coal (the successor of hpp-fcl; Montaut et al. 2024), pair by pair."""

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
