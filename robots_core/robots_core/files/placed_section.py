"""Names and poses of what stands in a scene or frames file."""

from math import pi, radians
from typing import Any, Final

from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector

FARTHEST: Final = 100.0  # m


def read_name(item: YamlSection, lines: dict[str, int]) -> str:
    """A name that no other item has; `lines` holds those of all, and takes this one.

    Raises:
        InvalidInputError: it is used already; with both lines.
    """
    name = item.text('name')
    if name in lines:
        raise item.error(f'the name {name!r} is used in line {lines[name]} already', 'name')
    lines[name] = item.line_of('name')
    return name


def read_pose(parts: YamlSection | None) -> Pose:
    """A pose: `position` and either `angles` or `quaternion`; the identity without a section.

    Raises:
        InvalidInputError: another value; with its line.
    """
    if parts is None:
        return Pose.identity()
    pose = Pose.identity()
    if 'position' in parts:
        pose = parts.made('position', lambda value: Pose(_position(value), pose.T))
    if 'angles' in parts and 'quaternion' in parts:
        raise parts.error('a pose has angles or a quaternion, not both')
    if 'quaternion' in parts:
        pose = parts.made('quaternion', lambda value: Pose.from_quaternion(pose.r, value))
    if 'angles' in parts:
        pose = parts.made('angles', lambda value: Pose.from_angles(pose.r, _angles(value)))
    parts.finish(('position', 'angles', 'quaternion'))
    return pose


def _position(value: Any) -> Array:
    r = finite_vector(value, 3, 'position')
    for length in r:
        if abs(length) >= FARTHEST:
            raise InvalidInputError(
                f'position has {length:g} m, not below {FARTHEST:g} m; lengths are metres: {1e-3 * length:g}?'
            )
    return r


def _angles(value: Any) -> Array:
    phi = finite_vector(value, 3, 'angles')
    for angle in phi:
        if abs(angle) > 2.0 * pi:
            raise InvalidInputError(
                f'angles has {angle:g} rad, more than a turn; angles of this file are radians: '
                f'{radians(angle):.4g}?'
            )
    return phi
