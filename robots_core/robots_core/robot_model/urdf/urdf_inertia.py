"""Masses and inertias of a URDF that no body has."""

import numpy as np
from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.urdf.urdf_place import line_of
from robots_core.validation import Array

# Figures have six digits or more, and sums of them the rounding of doubles.
RELATIVE_ROUNDING = 1e-6  # of the largest principal moment
ROUNDING = 1e-12  # kg m^2


def check_inertia(link: etree._Element) -> None:
    """Refuse a link that no body is like; nothing at all is taken for a frame.

    Args:
        link: Its element.

    Raises:
        UnknownRobotError: a mass that is negative, or 0 with an inertia, a negative principal moment, or
            what is no finite number. Moments that break the triangle inequality are taken: some makers
            publish those alone that count in their robot.
    """
    inertial = link.find('inertial')
    if inertial is None:
        return
    what = f'link {str(link.get("name"))!r}'
    mass = _number(inertial, what, 'mass', 'value')
    xx, yy, zz, xy, xz, yz = (
        _number(inertial, what, 'inertia', key) for key in ('ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz')
    )
    inertia: Array = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    small, middle, large = np.linalg.eigvalsh(inertia)
    if mass < 0.0 or (mass == 0.0 and inertia.any()):
        raise UnknownRobotError(
            f'{what} has a mass of {mass:g} kg; a body has more than 0 kg', **line_of(inertial)
        )
    if small < -(RELATIVE_ROUNDING * large + ROUNDING):
        raise UnknownRobotError(
            f'{what} has principal moments of inertia of {small:g}, {middle:g} and {large:g} kg m^2; a body '
            'has no negative ones',
            **line_of(inertial),
        )


def _number(inertial: etree._Element, what: str, tag: str, key: str) -> float:
    element = inertial.find(tag)
    if element is None:
        raise UnknownRobotError(f'{what} has an <inertial> without <{tag}>', **line_of(inertial))
    text = element.get(key)
    try:
        number = float(str(text))
    except ValueError:
        number = np.nan
    if not np.isfinite(number):
        raise UnknownRobotError(
            f'{what}: {key} = {text!r} of <{tag}> must be a finite number', **line_of(element)
        )
    return number
