"""Orbit: a satellite with an arm, the target that it is to grasp, and what holds and steadies both."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from robots_core.blocks.multibody.payload import Payload, payload_of
from robots_core.files.placed_section import read_pose
from robots_core.files.yaml_section import YamlSection, read_yaml
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector

FASTEST: Final = 1.0  # rad/s and m/s: far beyond what anything grasps


@dataclass(frozen=True, eq=False)
class Target:
    """A satellite out of control.

    Attributes:
        body: Mass and inertia, in the body's frame.
        pose: Of the body's frame in the world at the start.
        velocity: Of its centre of mass, (3,), m/s, world axes.
        angular_velocity: (3,), rad/s, in the body's axes.
        ring: Pose of tool0 in the body's frame when it grasps; its z points into the body.
        radius: Of a sphere about the centre of mass which the arm must not enter, m.
    """

    body: Payload
    pose: Pose
    velocity: Array
    angular_velocity: Array
    ring: Pose
    radius: float


@dataclass(frozen=True)
class Gripper:
    """What the gripper holds.

    Attributes:
        reach: Distance from tool0 to the ring within which it closes, m.
        speed: Highest speed of the ring relative to the gripper, m/s.
        rotation: Highest angular velocity of the target relative to the gripper, rad/s.
        duration: Time in which it closes, s: the joints take their impulse over it.
    """

    reach: float
    speed: float
    rotation: float
    duration: float


@dataclass(frozen=True)
class Wheels:
    """Three reaction wheels along the axes of the base.

    Attributes:
        torque: Highest, of each, N m.
        capacity: Largest angular momentum of each, N m s.
        time_constant: With which they stop what they have grasped, where their torque suffices, s.
    """

    torque: float
    capacity: float
    time_constant: float


@dataclass(frozen=True)
class Approach:
    """How the camera leads the gripper to the ring.

    Attributes:
        distance: Before the ring, along its z, at which the tool waits until it moves with the target, m.
        speed: With which it continues from there, m/s.
        camera_range: Distance from the base to the ring up to which the camera sees it, m.
    """

    distance: float
    speed: float
    camera_range: float


@dataclass(frozen=True, eq=False)
class Orbit:
    """State at the start. The world is a frame that moves with the orbit; forces in it are neglected.

    Attributes:
        target: The target.
        gripper: The gripper.
        wheels: The reaction wheels.
        approach: The approach.
        twist: Velocity (m/s) and angular velocity (rad/s) of the base, which is at the world's origin, (6,).
    """

    target: Target
    gripper: Gripper
    wheels: Wheels
    approach: Approach
    twist: Array = field(default_factory=lambda: np.zeros(6))


def read_orbit(path: Path | str) -> Orbit:
    """The orbit of a YAML file; `docs/reference/contact_and_orbit_files.md` describes it.

    Raises:
        InvalidInputError: a file that is missing or not such an orbit; names the file and the line.
    """
    section = read_yaml(path)
    orbit = Orbit(
        _target(section.needed_section('target')),
        Gripper(**_numbers(section.needed_section('gripper'), 'reach', 'speed', 'rotation', 'duration')),
        Wheels(**_numbers(section.needed_section('wheels'), 'torque', 'capacity', 'time_constant')),
        Approach(**_numbers(section.needed_section('approach'), 'distance', 'speed', 'camera_range')),
        _vector(section, 'twist', 6),
    )
    section.finish()
    return orbit


def _numbers(section: YamlSection, *keys: str) -> dict[str, float]:
    """Numbers above zero."""
    return {key: section.number(key, low=1e-6, high=1e6) for key in keys}


def _vector(section: YamlSection, key: str, size: int = 3) -> Array:
    if key not in section:
        return np.zeros(size)
    vector = section.made(key, lambda value: finite_vector(value, size, key))
    if np.abs(vector).max() > FASTEST:
        raise section.error(f'{key} is {vector.tolist()}; valid are values within +-{FASTEST:g}', key)
    return vector


def _target(section: YamlSection) -> Target:
    body = section.made('body', lambda values: payload_of(values if isinstance(values, list) else (), 'body'))
    if not (body.mass > 0.0 and np.linalg.eigvalsh(body.inertia)[0] > 0.0):
        raise section.error('body needs a mass and three moments of inertia above 0', 'body')
    return Target(
        body,
        read_pose(section.section('pose')),
        _vector(section, 'velocity'),
        _vector(section, 'angular_velocity'),
        read_pose(section.section('ring')),
        section.number('radius', low=0.0, high=100.0),
    )
