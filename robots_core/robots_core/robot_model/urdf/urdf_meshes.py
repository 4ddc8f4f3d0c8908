"""The mesh files of a URDF, and simple bodies in the place of those that are missing."""

import copy
from collections.abc import Mapping
from math import acos, atan2
from pathlib import Path
from typing import Final
from urllib.parse import unquote, urlparse

import numpy as np
from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.urdf.package_places import package_places
from robots_core.robot_model.urdf.substitutions import Substitutions
from robots_core.robot_model.urdf.urdf_tree import link_of
from robots_core.validation import Array

SLENDERNESS: Final = 0.05  # radius of the bodies for missing meshes, of the length of all links together
SMALLEST_RADIUS: Final = 0.005  # m


def mesh_path(filename: str, folder: Path) -> Path:
    """The file of a mesh name in a URDF.

    Args:
        filename: A relative or absolute path, `file://` with an absolute path, or
            `package://<package>/<path>`: looked for where `package_places` says, then beside the URDF.
        folder: Where relative names start.

    Raises:
        UnknownRobotError: no such file, or no file's name.
    """
    found = _found(filename, folder)
    if found is None:
        raise UnknownRobotError(
            f'mesh file {filename!r} not found {_searched(filename, folder)}', mesh=filename
        )
    return found


def _found(filename: str, folder: Path) -> Path | None:
    try:
        return next((path for path in _candidates(filename, folder) if path.is_file()), None)
    except (OSError, ValueError) as problem:  # too long, a null character, or no address
        raise UnknownRobotError(
            f'{filename[:100]!r} names no mesh file: {getattr(problem, "strerror", None) or problem}',
            mesh=filename,
        ) from None


def _searched(filename: str, folder: Path) -> str:
    packages = ', in AMENT_PREFIX_PATH and ROS_PACKAGE_PATH' if filename.startswith('package:') else ''
    return f'beside or below {folder}{packages}'


def _candidates(filename: str, folder: Path) -> list[Path]:
    parts = urlparse(filename)
    relative = unquote(parts.path).lstrip('/')
    if parts.scheme == 'file':
        return [Path(unquote(parts.path))]
    if parts.scheme == 'package':
        places = package_places(parts.netloc, folder)
        return [*(place / relative for place in places), folder / relative, folder / Path(relative).name]
    return [folder / filename]


def with_absolute_meshes(
    xml: str,
    folder: Path,
    substitutions: Substitutions | None = None,
    *,
    unreadable: UnknownRobotError | None = None,
) -> str:
    """The URDF text with every mesh named by an absolute `file://` address, which loads from any folder.

    A mesh that is missing is replaced by the other mesh of its link, that for display by that for collision
    checks and the other way round; where both are missing, by a cylinder or sphere between its joints. Where
    no link has a shape for collision checks, those for display are taken.

    Args:
        xml: The URDF.
        folder: Where relative names start.
        substitutions: Receives what is substituted; without it, missing meshes are refused.
        unreadable: About a mesh whose file is there, its detail `mesh`, and is replaced as if it were not.

    Raises:
        UnknownRobotError: a mesh file that is missing where nothing may be substituted, or no file's name.
    """
    root = etree.fromstring(xml.encode())
    if substitutions is not None:
        _collide_with_what_is_shown(root, substitutions)
    missing: dict[str, list[etree._Element]] = {}
    for link in root.iter('link'):
        lost = [mesh for mesh in link.iter('mesh') if not _made_absolute(mesh, folder, unreadable)]
        if lost and substitutions is None:
            mesh_path(_name(lost[0]), folder)
        missing |= {str(link.get('name')): lost} if lost else {}
    if missing and substitutions is not None:
        _substitute(root, missing, folder, substitutions, unreadable)
    return str(etree.tostring(root, encoding='unicode'))


def _collide_with_what_is_shown(root: etree._Element, substitutions: Substitutions) -> None:
    shown = [(link, visual) for link in root.iter('link') for visual in link.findall('visual')]
    if not shown or next(root.iter('collision'), None) is not None:
        return
    for link, visual in shown:
        _replace_shape(etree.SubElement(link, 'collision'), visual)
    substitutions.add('no link has a <collision>', 'what is shown by <visual>')


def _name(mesh: etree._Element) -> str:
    return str(mesh.get('filename'))


def _made_absolute(mesh: etree._Element, folder: Path, unreadable: UnknownRobotError | None) -> bool:
    path = _found(_name(mesh), folder)
    if path is None or (unreadable is not None and str(path) == unreadable.details['mesh']):
        return False
    mesh.set('filename', path.resolve().as_uri())
    return True


def _substitute(
    root: etree._Element,
    missing: Mapping[str, list[etree._Element]],
    folder: Path,
    substitutions: Substitutions,
    unreadable: UnknownRobotError | None,
) -> None:
    swapped: list[str] = []
    bodies: list[str] = []
    for name, lost in missing.items():
        link = next(link for link in root.iter('link') if link.get('name') == name)
        kept = [element for kind in ('visual', 'collision') for element in link.findall(kind)]
        kept = [element for element in kept if not any(mesh in lost for mesh in element.iter('mesh'))]
        for mesh in lost:
            element = next(one for one in link if mesh in list(one.iter('mesh')))
            others = [one for one in kept if one.tag != element.tag]
            if others:
                _replace_shape(element, others[0])
            else:
                _replace_shape(element, _simple_body(root, name))
        (swapped if kept else bodies).append(name)
    example = _name(next(iter(missing.values()))[0])
    lacking = f'there is no mesh file {example!r} {_searched(example, folder)}'
    number = sum(len(lost) for lost in missing.values())
    if unreadable is not None:
        lacking = unreadable.message
    elif number > 1:
        lacking = f'{number} mesh files are missing: {lacking}'
    taken = []
    if swapped:
        taken.append(f'the other mesh of {", ".join(swapped)}')
    if bodies:
        taken.append(f'cylinders and spheres between the joints of {", ".join(bodies)}')
    substitutions.add(lacking, ', and '.join(taken))


def _simple_body(root: etree._Element, link: str) -> etree._Element:
    """A body for a link, as a `<collision>`: a cylinder from its own joint to the farthest that it carries.

    It is a sphere at its own joint where there is no other, or where that is closer than the radius.
    """
    carried = [_offset(joint) for joint in root.findall('joint') if link_of(joint, 'parent') == link]
    end = max(carried, key=_length, default=np.zeros(3))
    radius = max(
        SLENDERNESS * sum(_length(_offset(joint)) for joint in root.findall('joint')), SMALLEST_RADIUS
    )
    element = etree.Element('collision')
    length = _length(end)
    if length <= radius:
        etree.SubElement(etree.SubElement(element, 'geometry'), 'sphere', radius=repr(radius))
        return element
    x, y, z = end
    turn = f'0 {acos(z / length)!r} {atan2(y, x)!r}'  # of z towards the other joint
    etree.SubElement(element, 'origin', xyz=' '.join(repr(float(half)) for half in 0.5 * end), rpy=turn)
    shape = etree.SubElement(element, 'geometry')
    etree.SubElement(shape, 'cylinder', radius=repr(radius), length=repr(length))
    return element


def _replace_shape(element: etree._Element, other: etree._Element) -> None:
    """Replace the place and the geometry of a `<visual>` or `<collision>` by those of another one."""
    for tag in ('origin', 'geometry'):
        for part in element.findall(tag):
            element.remove(part)
        for part in other.findall(tag):
            element.append(copy.deepcopy(part))


def _offset(joint: etree._Element) -> Array:
    origin = joint.find('origin')
    text = '0 0 0' if origin is None else str(origin.get('xyz', '0 0 0'))
    try:
        offset = np.array([float(part) for part in text.split()])
    except ValueError:
        offset = np.empty(0)
    if offset.shape != (3,) or not np.isfinite(offset).all():
        raise UnknownRobotError(f'joint {joint.get("name")!r}: xyz = {text!r} must be three numbers')
    return offset


def _length(vector: Array) -> float:
    return float(np.linalg.norm(vector))
