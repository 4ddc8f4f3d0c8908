"""MotionSettings: what holds for every motion until it is changed."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

import numpy as np

from robots_core.blocks.inverse_kinematics.hold import check_hold
from robots_core.blocks.multibody.payload import payload_of
from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_from_quaternion
from robots_core.pose import Pose
from robots_core.robot_model.analytic.configuration import Configuration
from robots_core.status import Status
from robots_core.validation import bounded_vector, finite_vector, one_of
from robots_planning.planner_choice import check_planner

IDENTITY: Final = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
DEFAULT_PLANNERS: Final = {'joint_planner': 'linear_joint', 'cartesian_planner': 'limited'}
NOTHING: Final = (0.0, 0.0, 0.0, 0.0)
FARTHEST: Final = {'tool': 10.0, 'base': 1000.0}  # m
ON_BLOCKED: Final = ('stop', 'replan')
SHOWN: Final = 60  # characters of a value that is refused
NORM_TOLERANCE = 1e-6  # of a quaternion; single precision is meant as one


@dataclass(frozen=True)
class MotionSettings:
    """Modal settings.

    Attributes:
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration and jerk limits to use, in (0, 1].
        cartesian_speed: Highest speed of the tool on Cartesian motions, m/s.
        cartesian_acceleration: Highest acceleration of the tool along its path, m/s^2.
        rotation_speed: Highest angular speed of the tool, rad/s.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2.
        jerk_limited: Keep the axes' jerk limits on Cartesian motions, in blended chains and with `avoid` too.
        joint_planner: Planner of joint motions: 'linear_joint' (all axes start and stop together) or
            'linear_joint_axes' (every axis as fast as it can), or another that is installed.
        cartesian_planner: Planner of Cartesian motions: 'limited' (velocity and acceleration),
            'dynamic_programming' (torque too, and configurations), or another that is installed.
        avoid: Joint motions go around obstacles, planned by 'collision_free' instead of
            `joint_planner`; where a line collides, the refusal says whether such a motion is free.
        avoid_budget: Longest search for a path around obstacles, in seconds at 25 000 postures per second:
            what is found does not depend on the computer.
        on_blocked: What becomes of a motion that goes around obstacles if one comes into
            its path and stops it: 'stop' ends it, 'replan' leads it around from where the robot stands.
        most_replans: How often one motion may go on so, 1 to 100.
        configuration: In which joint motions reach a pose, as 'front/up/no_flip'; '' for the nearest.
        hold: What motions to poses hold: 'pose', 'directions' (the position, and of the orientation what the
            arm can) or 'position'; '' for what the arm can.
        tool: Tool centre point in tool0: x, y, z (m) and quaternion x, y, z, w.
        base: Frame of all poses in the robot's base: the same seven numbers.
        payload: What tool0 carries: mass (kg), centre of mass x, y, z in tool0 (m), and maybe its inertia
            about that xx, xy, xz, yy, yz, zz (kg m^2). It counts in all torques.
        blend_zone: How far before and after its end a Cartesian motion may leave its path to run through to
            the next one, m; 0 stops at the end.
        joint_blend_zone: The same of a joint motion, rad (m) of the axis that moves most.

    Raises:
        InvalidInputError: a number outside its range in `RANGES`, a frame or
            payload that is none, or a planner or configuration that does not exist.
    """

    speed_fraction: float = 1.0
    acceleration_fraction: float = 1.0
    cartesian_speed: float = 0.5
    cartesian_acceleration: float = 2.0
    rotation_speed: float = 1.5
    rotation_acceleration: float = 6.0
    jerk_limited: bool = False
    joint_planner: str = DEFAULT_PLANNERS['joint_planner']
    cartesian_planner: str = DEFAULT_PLANNERS['cartesian_planner']
    avoid: bool = False
    avoid_budget: float = 2.0
    on_blocked: str = ON_BLOCKED[0]
    most_replans: int = 5
    configuration: str = ''
    hold: str = ''
    tool: tuple[float, ...] = IDENTITY
    base: tuple[float, ...] = IDENTITY
    payload: tuple[float, ...] = NOTHING
    blend_zone: float = 0.0
    joint_blend_zone: float = 0.0

    def __post_init__(self) -> None:
        for name, check in CHECKS.items():
            check(getattr(self, name), name)

    @property
    def blends(self) -> bool:
        """The motion may run through to the next one."""
        return self.blend_zone > 0.0 or self.joint_blend_zone > 0.0

    @property
    def replans(self) -> bool:
        """A joint motion goes around what stops it."""
        return self.avoid and self.on_blocked == 'replan'

    @property
    def tool_pose(self) -> Pose:
        """The tool centre point in tool0."""
        return frame(self.tool, 'tool')

    @property
    def tool_offset(self) -> Pose | None:
        """The same; None where it is tool0 itself."""
        return None if self.tool == IDENTITY else self.tool_pose

    def in_base(self, pose: Pose) -> Pose:
        """A pose in the commanded frame, in the robot's base."""
        return pose if self.base == IDENTITY else frame(self.base, 'base') @ pose


def frame(values: tuple[float, ...], name: str) -> Pose:
    """The pose of x, y, z (m) and a quaternion x, y, z, w.

    Raises:
        InvalidInputError: not seven finite numbers, too far away, or a quaternion that is not of length 1.
    """
    numbers = finite_vector(values, 7, name)
    bounded_vector(numbers[:3], 3, name, FARTHEST[name], 'm')
    norm = float(np.linalg.norm(numbers[3:]))
    if abs(norm - 1.0) > NORM_TOLERANCE:
        raise InvalidInputError(
            f'{name} = {list(values)} has a quaternion of length {norm:.6g}, a rotation has length 1'
        )
    return Pose(numbers[:3], rotation_from_quaternion(numbers[3:] / norm))


def frame_numbers(pose: Pose) -> tuple[float, ...]:
    """Inverse of `frame`."""
    return (*pose.r.tolist(), *pose.quaternion().tolist())


def known_configuration(text: str) -> Configuration | None:
    """The configuration of a setting; None for '', which is the nearest.

    Raises:
        InvalidInputError: no such configuration; names what is valid.
    """
    return Configuration.parse(text) if text else None


def _in_range(value: float, name: str) -> None:
    low, high, unit = RANGES[name]
    if not low <= value <= high:
        unit = f' {unit}' if unit else ''
        raise InvalidInputError(f'{name} = {value:.6g}{unit} must be in [{low:g}, {high:g}]{unit}')


def _flag(value: object, name: str) -> None:
    if not isinstance(value, bool):
        raise InvalidInputError(f'{name} = {value!r} must be true or false')


def _count(value: object, name: str) -> None:
    low, high, _ = RANGES[name]
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InvalidInputError(f'{name} = {value!r} must be a whole number in [{low:g}, {high:g}]')


def _planner(value: object, name: str) -> None:
    # The defaults are valid, and importing planners takes half a second, which readers of settings need not.
    if value != DEFAULT_PLANNERS[name]:
        check_planner(str(value), name)


RANGES: Final[dict[str, tuple[float, float, str]]] = {
    'speed_fraction': (1e-6, 1.0, ''),
    'acceleration_fraction': (1e-6, 1.0, ''),
    'cartesian_speed': (1e-5, 20.0, 'm/s'),
    'cartesian_acceleration': (1e-4, 1e3, 'm/s^2'),
    'rotation_speed': (1e-5, 100.0, 'rad/s'),
    'rotation_acceleration': (1e-4, 1e4, 'rad/s^2'),
    'avoid_budget': (0.01, 600.0, 's'),
    'most_replans': (1, 100, ''),
    'blend_zone': (0.0, 1.0, 'm'),
    'joint_blend_zone': (0.0, math.pi, 'rad (m)'),
}
"""Smallest and largest value of settings, with their unit: beyond these no arm works."""

CHECKS: Final[dict[str, Callable[[Any, str], object]]] = {
    **dict.fromkeys(RANGES, _in_range),
    'jerk_limited': _flag,
    'joint_planner': _planner,
    'cartesian_planner': _planner,
    'avoid': _flag,
    'on_blocked': lambda value, name: one_of(name, ON_BLOCKED)(value),
    'most_replans': _count,
    'configuration': lambda text, _: known_configuration(text),
    'hold': check_hold,
    'tool': frame,
    'base': frame,
    'payload': payload_of,
}
"""The check of each setting: takes value and name, raises InvalidInputError."""

DESCRIPTIONS: Final = {
    'speed_fraction': "part of the axes' velocity limits",
    'acceleration_fraction': "part of the axes' acceleration and jerk limits",
    'cartesian_speed': 'highest speed of the tool, m/s',
    'cartesian_acceleration': 'highest acceleration of the tool, m/s^2',
    'rotation_speed': 'highest angular speed of the tool, rad/s',
    'rotation_acceleration': 'highest angular acceleration of the tool, rad/s^2',
    'jerk_limited': 'keep jerk limits on Cartesian motions, in blended chains and with avoid too',
    'joint_planner': 'planner of joint motions: the name of an installed one',
    'cartesian_planner': 'planner of Cartesian motions: the name of an installed one',
    'avoid': 'joint motions go around obstacles',
    'avoid_budget': 'longest search for a path around obstacles, s at 25 000 postures per second',
    'on_blocked': "what an obstacle in the path does to a motion with avoid: 'stop', or 'replan' around it",
    'most_replans': 'how often one motion may be replanned',
    'configuration': "configuration of joint motions to a pose, as 'front/up/no_flip'; '' for the nearest",
    'hold': "what of poses is held: 'pose', 'directions' or 'position'; '' for what the arm can",
    'tool': 'tool centre point in tool0: x y z (m), quaternion x y z w',
    'base': "frame of poses in the robot's base: x y z (m), quaternion x y z w",
    'payload': 'on tool0: kg, centre x y z (m), maybe inertia xx xy xz yy yz zz (kg m^2)',
    'blend_zone': 'where a Cartesian motion may leave its path to run through to the next, m; 0 stops',
    'joint_blend_zone': 'the same of a joint motion, rad (m)',
}
"""One line per setting, for people."""

PENDANT: Final = 'pendant.'
"""Before the names of `PENDANT_SETTINGS`, as parameters of planning_node."""
PENDANT_SETTINGS: Final[Mapping[str, float]] = {
    'speed_fraction': 0.1,
    'acceleration_fraction': 0.3,
    'cartesian_speed': 0.25,
    'rotation_speed': 0.5,
}
"""What motions of the commander PENDANT have settings of their own for, with the defaults; they do not blend.

The settings of programs are never changed for a person, so nothing remains of a pendant that dies.
"""


def checked(name: str) -> Callable[[Any], object]:
    """The check of the setting `name`, for its value alone."""
    return lambda value: CHECKS[name](value, name)


def settings_status(settings: MotionSettings, pendant: Mapping[str, Any] | None = None) -> Status:
    """The settings as they travel on `motion_settings` and stand in bags: by name, each as JSON.

    Args:
        settings: Those of programs.
        pendant: Own ones of the pendant, of `PENDANT_SETTINGS`.
    """
    named = {**asdict(settings), **{f'{PENDANT}{name}': value for name, value in (pendant or {}).items()}}
    return Status('motion settings', values={name: json.dumps(value) for name, value in named.items()})


def of_pendant(settings: MotionSettings, own: Mapping[str, Any]) -> MotionSettings:
    """The settings of a motion of the commander PENDANT.

    Args:
        settings: Those of programs.
        own: Its own, of `PENDANT_SETTINGS`.
    """
    return replace(settings, **own, blend_zone=0.0, joint_blend_zone=0.0)


def settings_from_text(texts: Mapping[str, str], *, pendant: bool = False) -> MotionSettings:
    """The settings of a `settings_status`; what is missing has its default.

    Args:
        texts: By name; those of the pendant's own settings begin with `PENDANT`.
        pendant: Of a motion of the commander PENDANT.

    Raises:
        InvalidInputError: text that is no JSON, a setting that does not exist, or a value that is not valid.
    """
    values: dict[str, Any] = {}
    own: dict[str, Any] = {}
    for name, text in texts.items():
        found, known = (own, PENDANT_SETTINGS) if name.startswith(PENDANT) else (values, DESCRIPTIONS)
        key = name.removeprefix(PENDANT)
        if key not in known:
            raise InvalidInputError(f'unknown setting {name!r}; settings are {", ".join(DESCRIPTIONS)}')
        found[key] = _value_from_text(key, name, text)
    settings = MotionSettings(**values)
    return of_pendant(settings, own) if pendant else settings


def _value_from_text(setting: str, name: str, text: str) -> Any:
    default = getattr(MotionSettings, setting)
    try:
        value = json.loads(text)
        if isinstance(default, tuple) and isinstance(value, list) and all(map(_is_number, value)):
            return tuple(map(float, value))
        if isinstance(default, float) and _is_number(value):
            return float(value)
    except (ValueError, RecursionError, OverflowError):
        raise InvalidInputError(f'{name} = {text[:SHOWN]!r} is not JSON, or too large') from None
    if type(value) is not type(default):
        raise InvalidInputError(f'{name} = {text[:SHOWN]} is not of the type of {json.dumps(default)}')
    return value


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
