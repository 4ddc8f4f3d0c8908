"""The surface of any geometry as triangles."""

from typing import Final

import numpy as np
import trimesh

from robots_core.files.content_cache import Arrays, content_of, kept
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere

CREASE: Final = np.pi / 6  # rad; sharper edges stay visible, flatter ones are shaded smoothly


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


def shaded(geometry: Geometry) -> trimesh.Trimesh:
    """The surface of a geometry with doubled vertices at creases; that of a mesh is kept by content."""
    mesh = triangle_mesh(geometry)
    if not isinstance(geometry, Mesh):
        return trimesh.graph.smooth_shade(mesh, angle=CREASE)

    def shade() -> Arrays:
        smooth = trimesh.graph.smooth_shade(mesh, angle=CREASE)
        return {'vertices': np.asarray(smooth.vertices), 'faces': np.asarray(smooth.faces)}

    content = content_of((geometry.vertices, geometry.faces, CREASE))
    return trimesh.Trimesh(**kept('shaded', content, shade), process=False)
