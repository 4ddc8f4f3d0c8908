"""The surface of any geometry as triangles."""

import trimesh

from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere


def triangle_mesh(geometry: Geometry) -> trimesh.Trimesh:
    """The surface of a geometry as triangles, in its own frame, metres."""
    match geometry:
        case Box(size):
            return trimesh.creation.box(extents=size)
        case Cylinder(radius, length):
            return trimesh.creation.cylinder(radius=radius, height=length, sections=32)
        case Capsule(radius, length):
            return trimesh.creation.capsule(height=length, radius=radius, count=[16, 32])
        case Sphere(radius):
            return trimesh.creation.icosphere(subdivisions=2, radius=radius)
        case Mesh(vertices, faces):
            return trimesh.Trimesh(vertices, faces, process=False)
