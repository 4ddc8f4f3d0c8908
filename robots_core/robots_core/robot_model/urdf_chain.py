"""The serial chain inside a URDF, cut out and checked."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import yaml
from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.axes_data import AxesData

MOVING_JOINTS: Final = ('revolute', 'continuous', 'prismatic')

# The rule for a URDF that says nothing: full speed within half a second, full acceleration within a tenth.
DEFAULT_RAMP_TIME = 0.5  # s
DEFAULT_JERK_TIME = 0.1  # s

EXTRA_KEYS: Final = (
    'min_position',
    'max_position',
    'max_velocity',
    'max_acceleration',
    'max_jerk',
    'max_effort',
    'gear_ratio',
    'rotor_inertia',
)


@dataclass(frozen=True)
class UrdfChain:
    """A URDF reduced to one serial chain.

    Attributes:
        xml: URDF text: root is `base`, the chain's joints are the only moving ones.
        base: Name of the base link.
        tip: Name of the tool link.
        joints: Names of the moving joints, base to tip.
        axes_data: Their limits.
    """

    xml: str
    base: str
    tip: str
    joints: tuple[str, ...]
    axes_data: AxesData


def read_urdf_chain(
    xml: str, *, base: str | None = None, tip: str | None = None, joint_limits: Path | None = None
) -> UrdfChain:
    """Cut the chain from `base` to `tip` out of a URDF.

    Moving joints off the chain are held fixed at zero. Accelerations and jerks come from
    `joint_limits` (the format of MoveIt's joint_limits.yaml); where it has none, full speed is reached
    in 0.5 s and full acceleration in 0.1 s.

    Args:
        xml: URDF text.
        base: Base link; the URDF's root link by default.
        tip: Tool link; by default `tool0` if there is one, else the link behind the most moving joints.
        joint_limits: A YAML file with further limits.

    Raises:
        UnknownRobotError: not a URDF, no such link, no moving joint, or a moving joint without limits.
    """
    root = _parse(xml)
    children: dict[str, list[etree._Element]] = {}
    parent_joint: dict[str, etree._Element] = {}
    for joint in root.findall('joint'):
        children.setdefault(_link(joint, 'parent'), []).append(joint)
        parent_joint[_link(joint, 'child')] = joint
    links = [str(link.get('name')) for link in root.findall('link')]
    base = _pick_base(links, parent_joint, base)
    chain = _pick_chain(links, parent_joint, base, tip)
    moving = [joint for joint in chain if joint.get('type') in MOVING_JOINTS]
    if not moving:
        raise UnknownRobotError(f'the URDF has no moving joint from {base!r} to its tip')
    limits = _extra_limits(joint_limits)
    axes_data = _axes_data(root, moving, limits)
    _reduce(root, base, children, {str(joint.get('name')) for joint in moving})
    return UrdfChain(
        xml=etree.tostring(root, encoding='unicode'),
        base=base,
        tip=_link(chain[-1], 'child'),
        joints=axes_data.names,
        axes_data=axes_data,
    )


def pinocchio_xml(chain: UrdfChain) -> str:
    """The chain's URDF with continuous joints as revolute ones, so that q has one number per axis."""
    root = copy.deepcopy(_parse(chain.xml))
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
        raise UnknownRobotError(f'not a URDF: {error}') from error
    if root.tag != 'robot':
        raise UnknownRobotError(f'not a URDF: the root element is <{root.tag}>, not <robot>')
    return root


def _link(joint: etree._Element, role: str) -> str:
    element = joint.find(role)
    if element is None:
        raise UnknownRobotError(f'joint {joint.get("name")!r} has no <{role}> link')
    return str(element.get('link'))


def _pick_base(links: list[str], parent_joint: dict[str, etree._Element], base: str | None) -> str:
    if base is None:
        roots = [link for link in links if link not in parent_joint]
        if len(roots) != 1:
            raise UnknownRobotError(f'the URDF has {len(roots)} root links, one is valid: {roots}')
        return roots[0]
    if base not in links:
        raise UnknownRobotError(f'base link {base!r} not found; links are {", ".join(links)}')
    return base


def _pick_chain(
    links: list[str], parent_joint: dict[str, etree._Element], base: str, tip: str | None
) -> list[etree._Element]:
    def joints_to(link: str) -> list[etree._Element]:
        joints = []
        while link != base and link in parent_joint:
            joints.append(parent_joint[link])
            link = _link(joints[-1], 'parent')
        return joints[::-1] if link == base else []

    def moving(link: str) -> int:
        return sum(joint.get('type') in MOVING_JOINTS for joint in joints_to(link))

    if tip is not None and tip not in links:
        raise UnknownRobotError(f'tip link {tip!r} not found; links are {", ".join(links)}')
    if tip is None:
        tip = (
            'tool0' if 'tool0' in links else max(links, key=lambda link: (moving(link), len(joints_to(link))))
        )
    chain = joints_to(tip)
    if not chain:
        raise UnknownRobotError(f'no chain of joints leads from {base!r} to {tip!r}')
    for joint in chain:
        if joint.get('type') not in (*MOVING_JOINTS, 'fixed'):
            raise UnknownRobotError(
                f'joint {joint.get("name")!r} is {joint.get("type")!r}; joints of a chain are fixed, '
                f'{", ".join(MOVING_JOINTS)}'
            )
        if joint.find('mimic') is not None:
            raise UnknownRobotError(f'joint {joint.get("name")!r} mimics another, a chain needs its own axes')
    return chain


def _extra_limits(path: Path | None) -> dict[str, dict[str, float]]:
    if path is None:
        return {}
    if not path.is_file():
        raise UnknownRobotError(f'limits file {str(path)!r} not found')
    try:
        content = yaml.safe_load(path.read_text())
    except yaml.YAMLError as error:
        raise UnknownRobotError(f'{path.name}: not YAML: {error}') from error
    joints = content.get('joint_limits') if isinstance(content, dict) else None
    if not isinstance(joints, dict) or not all(isinstance(joint, dict) for joint in joints.values()):
        raise UnknownRobotError(f'{path.name}: expected a mapping `joint_limits:` of joint names')
    return {
        str(name): {
            key: _number(f'{path.name}: joint {str(name)!r}', key, value)
            for key, value in joint.items()
            if key in EXTRA_KEYS and joint.get(_switch(key), True)
        }
        for name, joint in joints.items()
    }


def _switch(key: str) -> str:
    """The key with which MoveIt's format switches a limit on or off."""
    return f'has_{key.partition("_")[2]}_limits'


def _number(where: str, key: str, value: object) -> float:
    try:
        return float(str(value))
    except ValueError as error:
        raise UnknownRobotError(f'{where}: {key} = {value!r} must be a number') from error


def _axes_data(
    root: etree._Element, moving: list[etree._Element], limits: dict[str, dict[str, float]]
) -> AxesData:
    columns: dict[str, list[float]] = {
        key: [] for key in ('lower', 'upper', 'velocity', 'acceleration', 'jerk', 'effort', 'gear', 'rotor')
    }
    reductions = _transmissions(root)
    for joint in moving:
        name = str(joint.get('name'))
        extra = limits.get(name, {})
        limit = joint.find('limit')
        given = (
            {}
            if limit is None
            else {
                str(key): _number(f'joint {name!r}', str(key), value) for key, value in limit.attrib.items()
            }
        )
        for key in ('velocity', 'effort'):
            if not given.get(key, 0.0) > 0.0:
                raise UnknownRobotError(f'joint {name!r} needs a {key} limit above 0 in <limit>')
        continuous = joint.get('type') == 'continuous'
        velocity = extra.get('max_velocity', given['velocity'])
        acceleration = extra.get('max_acceleration', velocity / DEFAULT_RAMP_TIME)
        columns['lower'].append(extra.get('min_position', -np.inf if continuous else given.get('lower', 0.0)))
        columns['upper'].append(extra.get('max_position', np.inf if continuous else given.get('upper', 0.0)))
        columns['velocity'].append(velocity)
        columns['acceleration'].append(acceleration)
        columns['jerk'].append(extra.get('max_jerk', acceleration / DEFAULT_JERK_TIME))
        columns['effort'].append(extra.get('max_effort', given['effort']))
        columns['gear'].append(extra.get('gear_ratio', reductions.get(name, np.nan)))
        columns['rotor'].append(extra.get('rotor_inertia', 0.0))
    return AxesData(
        names=tuple(str(joint.get('name')) for joint in moving),
        lower=np.array(columns['lower']),
        upper=np.array(columns['upper']),
        velocity=np.array(columns['velocity']),
        acceleration=np.array(columns['acceleration']),
        jerk=np.array(columns['jerk']),
        effort=np.array(columns['effort']),
        gear_ratio=np.array(columns['gear']),
        rotor_inertia=np.array(columns['rotor']),
        prismatic=tuple(joint.get('type') == 'prismatic' for joint in moving),
    )


def _transmissions(root: etree._Element) -> dict[str, float]:
    reductions = {}
    for transmission in root.findall('transmission'):
        joint = transmission.find('joint')
        reduction = transmission.findtext('.//mechanicalReduction')
        if joint is not None and reduction is not None:
            name = str(joint.get('name'))
            reductions[name] = _number(f'transmission of joint {name!r}', 'mechanicalReduction', reduction)
    return reductions


def _reduce(
    root: etree._Element, base: str, children: dict[str, list[etree._Element]], moving: set[str]
) -> None:
    """Keep what hangs on `base`; hold every joint fixed that is not in `moving`."""
    kept_links, kept_joints = {base}, set()
    pending = [base]
    while pending:
        for joint in children.get(pending.pop(), []):
            kept_joints.add(str(joint.get('name')))
            kept_links.add(_link(joint, 'child'))
            pending.append(_link(joint, 'child'))
    for element in list(root):
        name = element.get('name')
        keep = {'link': kept_links, 'joint': kept_joints}.get(str(element.tag))
        if keep is not None and name not in keep:
            root.remove(element)
        elif element.tag == 'joint' and name not in moving:
            element.set('type', 'fixed')
            for tag in ('axis', 'limit', 'mimic', 'dynamics'):
                for part in element.findall(tag):
                    element.remove(part)
