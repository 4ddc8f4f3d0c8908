"""The serial chain inside a URDF, cut out and checked."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from lxml import etree

from robots_core.errors import InvalidInputError, UnknownRobotError
from robots_core.files.yaml_section import read_yaml_data
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.urdf.substitutions import Substitutions
from robots_core.robot_model.urdf.urdf_place import line_of
from robots_core.robot_model.urdf.urdf_tree import MOVING_JOINTS, TOOL, LinkTree
from robots_core.validation import Array

# Defaults for limits that the files lack: full speed within half a second, full acceleration within a tenth.
DEFAULT_RAMP_TIME = 0.5  # s
DEFAULT_JERK_TIME = 0.1  # s
# In place of limits of 0, which URDFs have where their makers published none.
SUBSTITUTE_SPEEDS: Final = {False: np.pi / 2, True: 0.5}  # rad/s, and m/s of axes that slide
SUBSTITUTE_EFFORT: Final = 1000.0  # N m (N), of a robot without masses

# Of moments of inertia: figures have six digits or more, and sums of them the rounding of doubles.
RELATIVE_ROUNDING: Final = 1e-6  # of the largest principal moment
ROUNDING: Final = 1e-12  # kg m^2

XACRO: Final = 'http://www.ros.org/wiki/xacro'

EXTRA_KEYS: Final = (
    'min_position',
    'max_position',
    'max_velocity',
    'max_acceleration',
    'max_jerk',
    'max_effort',
    'gear_ratio',
    'rotor_inertia',
    'coulomb_friction',
    'viscous_friction',
)


@dataclass(frozen=True)
class UrdfChain:
    """A URDF reduced to one serial chain.

    Attributes:
        root: Its element: `base` is the root, the chain's joints are the only moving ones, and a link `tool0`
            marks the tip unless the URDF has one elsewhere.
        base: Name of the base link.
        tip: Name of the tool link.
        axes_data: Names and limits of the moving joints, base to tip.
        unknown_effort: Which of them have `SUBSTITUTE_EFFORT`, as the files state none.
    """

    root: etree._Element
    base: str
    tip: str
    axes_data: AxesData
    unknown_effort: tuple[bool, ...]

    @property
    def xml(self) -> str:
        """URDF text, with the limits of `axes_data`."""
        _write_limits(self.root, self.axes_data)
        return str(etree.tostring(self.root, encoding='unicode'))


def read_urdf_chain(
    xml: str,
    *,
    base: str | None = None,
    tip: str | None = None,
    joint_limits: Path | None = None,
    beside: bool = False,
    substitutions: Substitutions | None = None,
) -> UrdfChain:
    """Cut the chain from `base` to `tip` out of a URDF.

    The default base is the URDF's root. The default tip is `tool0` if there is one; else the chain follows at
    every branch the link with the most axes. It ends before branches that are shorter than the chain so
    far: the fingers of a hand. After the last axis, the fixed links are followed to the end. Branches of
    equal length (two arms, four legs) are refused: choose a tip.

    Moving joints off the chain, such as fingers or joints that mimic others, are held fixed at zero.
    Accelerations and jerks come from `joint_limits` (the format of MoveIt's joint_limits.yaml), which
    overrides the URDF for every other limit too, for friction (`<dynamics>`) and for gear ratios; where it
    has none, full speed is reached in 0.5 s and full acceleration in 0.1 s. A speed or an effort that is
    missing or 0 is unknown, and substituted.

    Args:
        xml: URDF text.
        base: Base link.
        tip: Tool link.
        joint_limits: A YAML file with further limits.
        beside: It lies beside the URDF: makers have files of this name with other contents, which are
            passed over.
        substitutions: Receives what is substituted; without it, unknown limits are refused.

    Raises:
        UnknownRobotError: not a URDF, no such link, no single chain, no moving joint, or limits that are
            unknown where nothing may be substituted, or a link with the mass or inertia of no body.
        InvalidInputError: limits that contradict each other.
    """
    root = _parse(xml)
    tree = LinkTree(root)
    base = tree.base(base)
    tip = tree.tip(base, tip)
    chain = tree.chain(base, tip)
    moving = [joint for joint in chain if joint.get('type') in MOVING_JOINTS]
    if not moving:
        raise UnknownRobotError(f'the URDF has no moving joint from {base!r} to {tip!r}')
    substitutions = Substitutions(strict=True) if substitutions is None else substitutions
    axes_data, unknown_effort = _axes_data(
        root, moving, _extra_limits(joint_limits, substitutions if beside else None), substitutions
    )
    _reduce(root, tree.below(base), {str(joint.get('name')) for joint in moving})
    for link in root.findall('link'):
        _check_inertia(link)
    if TOOL not in tree.links:
        _add_tool(root, tip)
    return UrdfChain(root, base, tip, axes_data, unknown_effort)


def pinocchio_xml(chain: UrdfChain) -> str:
    """The chain's URDF with continuous joints as revolute ones, so that q has one number per axis."""
    root = etree.fromstring(chain.xml.encode())
    for joint in root.findall('joint'):
        if joint.get('type') == 'continuous':
            joint.set('type', 'revolute')
            limit = joint.find('limit')
            limit = etree.SubElement(joint, 'limit') if limit is None else limit
            for key, value in (('lower', '-1e3'), ('upper', '1e3'), ('velocity', '1'), ('effort', '1')):
                limit.set(key, limit.get(key, value))
    return str(etree.tostring(root, encoding='unicode'))


def _parse(xml: str) -> etree._Element:
    try:
        root = etree.fromstring(xml.encode())
    except etree.XMLSyntaxError as error:
        line = error.lineno or 1
        raise UnknownRobotError(f'not a URDF: {error.msg}', line=line) from error
    if root.tag != 'robot':
        raise UnknownRobotError(f'not a URDF: the root element is <{root.tag}>, not <robot>', **line_of(root))
    _drop_unused_properties(root, xml)
    if (first := next(root.iter(f'{{{XACRO}}}*'), None)) is not None:
        raise UnknownRobotError(
            'not a URDF but a xacro file: load it by the name xacro:/path/to/robot.urdf.xacro, or expand it '
            'first (xacro robot.xacro > robot.urdf)',
            **line_of(first),
        )
    return root


def _drop_unused_properties(root: etree._Element, xml: str) -> None:
    # Some makers' URDFs still define what the xacro file used that they were made from.
    if '${' in xml or '$(' in xml:
        return
    for name in ('property', 'arg'):
        for unused in list(root.iter(f'{{{XACRO}}}{name}')):
            unused.getparent().remove(unused)


def _extra_limits(path: Path | None, foreign: Substitutions | None) -> dict[str, dict[str, float]]:
    """The numbers of a limits file; none of one with other contents, which `foreign` receives."""
    if path is None:
        return {}
    try:
        content = read_yaml_data(path, 'limits file')
    except InvalidInputError as error:
        raise UnknownRobotError(error.message, **{'file': path.name, **error.details}) from None
    if foreign is not None and isinstance(content, dict) and 'joint_limits' not in content:
        foreign.add(f'{path.name} beside the URDF has no mapping joint_limits:', 'the limits of the URDF')
        return {}
    joints = content.get('joint_limits') if isinstance(content, dict) else None
    if not isinstance(joints, dict) or not all(isinstance(joint, dict) for joint in joints.values()):
        raise UnknownRobotError(
            f'{path.name}: expected a mapping `joint_limits:` of joint names', file=path.name
        )
    # MoveIt's format has a key that switches a limit on or off.
    return {
        str(name): {
            key: _number(f'{path.name}: joint {str(name)!r}', key, value, file=path.name)
            for key, value in joint.items()
            if key in EXTRA_KEYS and joint.get(f'has_{key.partition("_")[2]}_limits', True)
        }
        for name, joint in joints.items()
    }


def _number(where: str, key: str, value: object, **details: str | float) -> float:
    try:
        return float(str(value))
    except ValueError as error:
        raise UnknownRobotError(f'{where}: {key} = {value!r} must be a number', **details) from error


def _axes_data(
    root: etree._Element,
    moving: list[etree._Element],
    limits: dict[str, dict[str, float]],
    substitutions: Substitutions,
) -> tuple[AxesData, tuple[bool, ...]]:
    rows: list[dict[str, float]] = []
    unknown: dict[str, list[str]] = {'velocity': [], 'effort': []}
    reductions = _transmissions(root)
    for joint in moving:
        name = str(joint.get('name'))
        extra = limits.get(name, {})
        given, resistance = _numbers(joint, 'limit'), _numbers(joint, 'dynamics')
        substitutes = {
            'velocity': SUBSTITUTE_SPEEDS[joint.get('type') == 'prismatic'],
            'effort': SUBSTITUTE_EFFORT,
        }
        for key, substitute in substitutes.items():
            given[key] = extra.get(f'max_{key}', given.get(key, 0.0))
            if given[key] == 0.0:
                unknown[key].append(name)
                given[key] = substitute
        continuous = joint.get('type') == 'continuous'
        velocity = given['velocity']
        acceleration = extra.get('max_acceleration', velocity / DEFAULT_RAMP_TIME)
        rows.append(
            {
                'lower': extra.get('min_position', -np.inf if continuous else given.get('lower', 0.0)),
                'upper': extra.get('max_position', np.inf if continuous else given.get('upper', 0.0)),
                'velocity': velocity,
                'acceleration': acceleration,
                'jerk': extra.get('max_jerk', acceleration / DEFAULT_JERK_TIME),
                'effort': given['effort'],
                'gear_ratio': extra.get('gear_ratio', reductions.get(name, np.nan)),
                'rotor_inertia': extra.get('rotor_inertia', 0.0),
                'coulomb_friction': extra.get('coulomb_friction', resistance.get('friction', 0.0)),
                'viscous_friction': extra.get('viscous_friction', resistance.get('damping', 0.0)),
            }
        )
    for key, names in unknown.items():
        if names:
            substitutions.refuse(_without(key, names))
    if unknown['velocity']:
        substitutions.add(
            _without('velocity', unknown['velocity']),
            '90 degrees/s, or 0.5 m/s of axes that slide',
        )
    try:
        axes_data = AxesData(
            names=tuple(str(joint.get('name')) for joint in moving),
            prismatic=tuple(joint.get('type') == 'prismatic' for joint in moving),
            **{key: np.array([row[key] for row in rows]) for key in rows[0]},
        )
    except InvalidInputError as error:
        lines = {
            str(joint.get('name')): line_of(joint) for joint in moving if joint.get('name') not in limits
        }
        error.details |= lines.get(str(error.details.get('joint')), {})
        raise
    return axes_data, tuple(name in unknown['effort'] for name in axes_data.names)


def _without(key: str, names: Sequence[str]) -> str:
    joints = ', '.join(names)
    return f'{joints}: no {key} limit above 0, as {key} in <limit> or as max_{key} in joint_limits.yaml'


def _numbers(joint: etree._Element, tag: str) -> dict[str, float]:
    """The attributes of an element of a joint; none where the URDF lacks it."""
    element, where = joint.find(tag), f'joint {str(joint.get("name"))!r}'
    attributes = {} if element is None else element.attrib
    line = {} if element is None else line_of(element)
    return {str(key): _number(where, str(key), value, **line) for key, value in attributes.items()}


def _transmissions(root: etree._Element) -> dict[str, float]:
    reductions = {}
    for transmission in root.findall('transmission'):
        joint = transmission.find('joint')
        reduction = transmission.findtext('.//mechanicalReduction')
        if joint is not None and reduction is not None:
            name = str(joint.get('name'))
            where = f'transmission of joint {name!r}'
            reductions[name] = _number(where, 'mechanicalReduction', reduction, **line_of(transmission))
    return reductions


def _reduce(root: etree._Element, kept: tuple[set[str], set[str]], moving: set[str]) -> None:
    """Keep the links and joints `kept`; hold every joint fixed that is not in `moving`."""
    links, joints = kept
    for element in list(root):
        name = element.get('name')
        keep = {'link': links, 'joint': joints}.get(str(element.tag))
        if keep is not None and name not in keep:
            root.remove(element)
        elif element.tag == 'joint' and name not in moving:
            element.set('type', 'fixed')
            for tag in ('axis', 'limit', 'mimic', 'dynamics'):
                for part in element.findall(tag):
                    element.remove(part)


def _write_limits(root: etree._Element, axes: AxesData) -> None:
    """Write the limits into the URDF, so that it agrees with the axes' data."""
    joints = {joint.get('name'): joint for joint in root.findall('joint')}
    for index, name in enumerate(axes.names):
        joint = joints[name]
        limit = joint.find('limit')
        limit = etree.SubElement(joint, 'limit') if limit is None else limit
        if axes.continuous[index]:
            joint.set('type', 'continuous')
            for key in ('lower', 'upper'):
                limit.attrib.pop(key, None)
        else:
            if joint.get('type') == 'continuous':
                joint.set('type', 'revolute')
            limit.set('lower', repr(float(axes.lower[index])))
            limit.set('upper', repr(float(axes.upper[index])))
        limit.set('velocity', repr(float(axes.velocity[index])))
        limit.set('effort', repr(float(axes.effort[index])))


def _add_tool(root: etree._Element, tip: str) -> None:
    etree.SubElement(root, 'link', name=TOOL)
    joint = etree.SubElement(root, 'joint', name=f'{TOOL}_joint', type='fixed')
    etree.SubElement(joint, 'parent', link=tip)
    etree.SubElement(joint, 'child', link=TOOL)


def _check_inertia(link: etree._Element) -> None:
    """Refuse a link with the mass or inertia of no body; one with neither is a frame.

    Moments that break the triangle inequality are taken: some makers publish those alone that count in
    their robot.
    """
    inertial = link.find('inertial')
    if inertial is None:
        return
    what = f'link {str(link.get("name"))!r}'
    mass = _finite_number(inertial, what, 'mass', 'value')
    xx, yy, zz, xy, xz, yz = (
        _finite_number(inertial, what, 'inertia', key) for key in ('ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz')
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


def _finite_number(inertial: etree._Element, what: str, tag: str, key: str) -> float:
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
