"""Shapes of a URDF's links, each fixed to the axis frame that carries the link."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote, urlparse

import numpy as np
import pinocchio as pin
import yourdfpy
from lxml import etree

from robots_core.errors import InvalidInputError, UnknownRobotError
from robots_core.pose import Pose
from robots_core.robot_model.mesh_file import read_mesh
from robots_core.robot_model.shapes import Box, Cylinder, Geometry, Shape, Sphere

DEFAULT_COLOUR = (0.7, 0.7, 0.7, 1.0)


def urdf_shapes(
    description: yourdfpy.URDF, model: pin.Model, folder: Path, kind: Literal['visual', 'collision']
) -> tuple[Shape, ...]:
    """All visual or collision shapes of a URDF.

    Args:
        description: The URDF, parsed.
        model: The Pinocchio model of the same URDF: tells which axis carries which link, and where.
        folder: Where relative mesh file names start.
        kind: Which of a link's shapes.

    Raises:
        UnknownRobotError: a mesh file that is missing or cannot be read.
    """
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
                    geometry=_geometry(element.geometry, folder),
                    frame=int(frame.parentJoint),
                    pose=Pose(placement.translation, placement.rotation),
                    colour=_colour(element, palette) if kind == 'visual' else DEFAULT_COLOUR,
                    name=f'{link.name}/{element.name or index}',
                )
            )
    return tuple(shapes)


def _colour(element: Any, palette: dict[str, tuple[float, ...]]) -> tuple[float, float, float, float]:
    material = element.material
    if material is None:
        return DEFAULT_COLOUR
    rgba = palette.get(material.name, DEFAULT_COLOUR)
    if material.color is not None:
        rgba = tuple(float(part) for part in material.color.rgba)
    red, green, blue, opacity = rgba
    return red, green, blue, opacity


def _geometry(geometry: Any, folder: Path) -> Geometry:
    if geometry.box is not None:
        x, y, z = (float(edge) for edge in geometry.box.size)
        return Box((x, y, z))
    if geometry.cylinder is not None:
        return Cylinder(float(geometry.cylinder.radius), float(geometry.cylinder.length))
    if geometry.sphere is not None:
        return Sphere(float(geometry.sphere.radius))
    path = mesh_path(str(geometry.mesh.filename), folder)
    try:
        return read_mesh(path, 1.0 if geometry.mesh.scale is None else geometry.mesh.scale)
    except InvalidInputError as error:
        raise UnknownRobotError(str(error)) from error


def mesh_path(filename: str, folder: Path) -> Path:
    """The file that a URDF's mesh name means.

    Args:
        filename: A relative or absolute path, `file://` with an absolute path, or
            `package://<package>/<path>`: looked for in the folders above the URDF, then among the
            installed ROS packages.
        folder: Where relative names start.

    Raises:
        UnknownRobotError: no such file.
    """
    parts = urlparse(filename)
    relative = unquote(parts.path).lstrip('/')
    if parts.scheme == 'file':
        candidates = [Path(unquote(parts.path))]
    elif parts.scheme == 'package':
        above = [folder.resolve(), *folder.resolve().parents]
        candidates = [parent / relative for parent in above if parent.name == parts.netloc]
        candidates += [parent / parts.netloc / relative for parent in above]
        prefixes = filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep))
        candidates += [Path(prefix) / 'share' / parts.netloc / relative for prefix in prefixes]
    else:
        candidates = [folder / filename]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise UnknownRobotError(f'mesh file {filename!r} not found below {folder}')


def with_absolute_meshes(xml: str, folder: Path) -> str:
    """The URDF text with every mesh named by an absolute `file://` address, so that anyone can load it.

    Raises:
        UnknownRobotError: a mesh file that is missing.
    """
    root = etree.fromstring(xml.encode())
    for mesh in root.iter('mesh'):
        mesh.set('filename', mesh_path(str(mesh.get('filename')), folder).resolve().as_uri())
    return str(etree.tostring(root, encoding='unicode'))
