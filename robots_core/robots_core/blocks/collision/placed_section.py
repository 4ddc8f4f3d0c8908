"""Names and poses of what stands in a scene file."""

from robots_core.pose import Pose
from robots_core.validation import finite_vector
from robots_core.yaml_section import YamlSection


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
        pose = parts.made('position', lambda value: Pose(finite_vector(value, 3, 'position'), pose.T))
    if 'angles' in parts and 'quaternion' in parts:
        raise parts.error('a pose has angles or a quaternion, not both')
    if 'quaternion' in parts:
        pose = parts.made('quaternion', lambda value: Pose.from_quaternion(pose.r, value))
    if 'angles' in parts:
        pose = parts.made('angles', lambda value: Pose.from_angles(pose.r, value))
    parts.finish(('position', 'angles', 'quaternion'))
    return pose
