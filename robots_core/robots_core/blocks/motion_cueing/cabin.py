"""Cabin: where a simulator's cabin hangs on its robot, how far it may move, and what it is to feel like."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from robots_core.blocks.motion_cueing.cabin_envelope import CabinEnvelope
from robots_core.blocks.motion_cueing.driven_vehicle import VehicleData
from robots_core.blocks.motion_cueing.washout_settings import WashoutSettings
from robots_core.errors import InvalidInputError
from robots_core.files.placed_section import read_pose
from robots_core.files.yaml_section import YamlSection, read_yaml
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector

if TYPE_CHECKING:
    from robots_core.blocks.motion_cueing.motion_cueing import CueingStep

Made = TypeVar('Made')


@dataclass(frozen=True, eq=False, kw_only=True)
class Cabin:
    """A cabin on the flange (tool0) of a robot.

    Attributes:
        flange: Pose of tool0 in the robot's base where the cabin stands in its middle.
        head: Pose of the person's head in tool0: x forward, y left, z up.
        envelope: How far the head may move from there.
        washout: Parameters of the filter.
        vehicle: The car that a driver's inputs drive.
    """

    flange: Pose
    head: Pose
    envelope: CabinEnvelope
    washout: WashoutSettings = field(default_factory=WashoutSettings)
    vehicle: VehicleData = field(default_factory=VehicleData)

    def flange_of(self, step: CueingStep) -> Pose:
        """Pose of tool0 in the robot's base, for a motion of the cabin."""
        return self.flange @ self.head @ step.pose @ self.head.inverse()

    def twist_of(self, step: CueingStep) -> Array:
        """Velocity and angular velocity of tool0, (6,) m/s and rad/s, in the robot's base."""
        middle = self.flange.T @ self.head.T
        velocity, angular_velocity = step.twist.reshape(2, 3) @ middle.T
        arm = self.flange_of(step).T @ -self.head.r  # from the head to the flange
        return np.concatenate([velocity + np.cross(angular_velocity, arm), angular_velocity])

    def head_at(self, flange: Pose) -> Pose:
        """Pose of the head from the middle of its motion, for a pose of tool0 in the robot's base."""
        return (self.flange @ self.head).inverse() @ flange @ self.head


def read_cabin(path: Path | str) -> Cabin:
    """The cabin of a YAML file; `docs/how_to/motion_simulator.md` describes the format.

    Raises:
        InvalidInputError: a file that is missing or not such a cabin; names the file and the line.
    """
    section = read_yaml(path)
    flange, head = (read_pose(section.needed_section(name)) for name in ('flange', 'head'))
    envelope = _made(section.needed_section('envelope'), CabinEnvelope)
    washout = _made(section.section('washout'), WashoutSettings)
    vehicle = _made(section.section('vehicle'), VehicleData)
    section.finish()
    return Cabin(flange=flange, head=head, envelope=envelope, washout=washout, vehicle=vehicle)


def _made(section: YamlSection | None, kind: type[Made]) -> Made:
    """A dataclass of numbers and rows of numbers; that of its defaults without a section."""
    if section is None:
        return kind()
    values: dict[str, Any] = {}
    for item in fields(kind):  # type: ignore[arg-type]
        if item.name in section or item.default is MISSING:
            row = item.default is MISSING or isinstance(item.default, tuple)
            values[item.name] = section.made(item.name, _row) if row else section.number(item.name)
    section.finish([item.name for item in fields(kind)])  # type: ignore[arg-type]
    return section.checked(lambda: kind(**values))


def _row(values: Any) -> tuple[float, ...]:
    if not isinstance(values, list):
        raise InvalidInputError(f'{values!r} must be a list of numbers')
    return tuple(finite_vector(values, len(values), 'list').tolist())
