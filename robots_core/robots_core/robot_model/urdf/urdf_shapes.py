"""Shapes of a URDF's links, each fixed to the axis frame that carries the link."""

import io
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pinocchio as pin
import yourdfpy

from robots_core.errors import InvalidInputError, RobotsError, UnknownRobotError
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box, Colour, Cylinder, Geometry, Shape, Sphere, drawable_colour
from robots_core.robot_model.urdf.mesh_file import read_mesh
from robots_core.robot_model.urdf.outer_hull import read_outer_hull
from robots_core.robot_model.urdf.urdf_meshes import mesh_path

DEFAULT_COLOUR: Colour = (0.7, 0.7, 0.7, 1.0)


def urdf_shapes(
    xml: str, model: pin.Model, kind: Literal['visual', 'collision'], *, hulls: bool = False
) -> tuple[Shape, ...]:
    """All visual or collision shapes of a URDF, with convex bodies around detailed meshes if `hulls`.

    The meshes are named by absolute addresses. The Pinocchio model of the same URDF holds the axis that
    carries each link, and the link's pose.

    Raises:
        UnknownRobotError: a mesh file that is missing or cannot be read (its detail `mesh`), or a shape that
            is none.
    """
    try:
        return _shapes(xml, model, kind, hulls=hulls)
    except RobotsError:
        raise
    except Exception as error:
        # The parser of yourdfpy raises whatever a wrong number or a missing element leads to.
        raise UnknownRobotError(f'the {kind} shapes of the URDF cannot be read: {error}') from error


def _shapes(
    xml: str, model: pin.Model, kind: Literal['visual', 'collision'], *, hulls: bool
) -> tuple[Shape, ...]:
    description = yourdfpy.URDF.load(
        io.BytesIO(xml.encode()), build_scene_graph=False, load_meshes=False, load_collision_meshes=False
    )
    palette = {
        material.name: tuple(float(part) for part in material.color.rgba)
        for material in description.robot.materials
        if material.color is not None
    }
    shapes: list[Shape] = []
    for link in description.robot.links:
        # A joint may have the same name.
        frame = model.frames[model.getFrameId(link.name, pin.FrameType.BODY)]
        for index, element in enumerate(link.visuals if kind == 'visual' else link.collisions):
            local = np.eye(4) if element.origin is None else np.asarray(element.origin, dtype=np.float64)
            placement = frame.placement * pin.SE3(local[:3, :3], local[:3, 3])
            shapes.append(
                Shape(
                    geometry=_geometry(element.geometry, hulls=hulls),
                    frame=int(frame.parentJoint),
                    pose=Pose(placement.translation, placement.rotation),
                    colour=_colour(element, palette) if kind == 'visual' else DEFAULT_COLOUR,
                    name=f'{link.name}/{element.name or index}',
                )
            )
    return tuple(shapes)


def _colour(element: Any, palette: dict[str, tuple[float, ...]]) -> Colour:
    material = element.material
    if material is None:
        return DEFAULT_COLOUR
    rgba = palette.get(material.name, DEFAULT_COLOUR)
    if material.color is not None:
        rgba = tuple(float(part) for part in material.color.rgba)
    return drawable_colour(rgba, DEFAULT_COLOUR)


def _geometry(geometry: Any, *, hulls: bool) -> Geometry:
    if geometry.box is not None:
        x, y, z = (float(edge) for edge in geometry.box.size)
        return Box((x, y, z))
    if geometry.cylinder is not None:
        return Cylinder(float(geometry.cylinder.radius), float(geometry.cylinder.length))
    if geometry.sphere is not None:
        return Sphere(float(geometry.sphere.radius))
    path = mesh_path(str(geometry.mesh.filename), Path())
    scale = 1.0 if geometry.mesh.scale is None else geometry.mesh.scale
    try:
        return read_outer_hull(path, scale) if hulls else read_mesh(path, scale)
    except InvalidInputError as error:
        raise UnknownRobotError(str(error), mesh=str(path)) from error
