"""Simple bodies in the place of meshes that are missing: cylinders and spheres between joints."""

import copy
from math import acos, atan2
from typing import Final

import numpy as np
from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.urdf.urdf_tree import link_of
from robots_core.validation import Array

SLENDERNESS: Final = 0.05  # radius of the bodies, of the length of all links together
SMALLEST_RADIUS: Final = 0.005  # m


def simple_body(root: etree._Element, link: str) -> etree._Element:
    """A body for a link, as a `<collision>`: a cylinder from its own joint to the farthest that it carries.

    It is a sphere at its own joint where there is no other, or where that is closer than the radius.

    Args:
        root: The URDF.
        link: The link's name.

    Raises:
        UnknownRobotError: an `<origin>` that is no three numbers.
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


def replace_shape(element: etree._Element, other: etree._Element) -> None:
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
