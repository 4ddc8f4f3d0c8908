"""MotionPrimitive: PTP, LIN and CIRC with a blend radius, as drivers of robots take them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_kinds import CIRCLE, JOINT, LINE, MotionKind
from robots_planning.motion_settings import RANGES, MotionSettings
from robots_planning.trajectory_generators.trajectory_generator import Target, usable_fraction

ARGUMENTS: Final = ('velocity', 'acceleration')
"""Names of what a primitive may have besides: of the tool (m/s, m/s^2), or of the fastest axis."""
ARC_POSES: Final = 2  # a point on the way, and the end
MOST_PRIMITIVES: Final = 255
"""Of a sequence: their index is one byte."""


@dataclass(frozen=True, eq=False)
class MotionPrimitive:
    """One motion of a sequence.

    Attributes:
        kind: What kind of motion it is.
        target: See `PathPlanning.plan`.
        blend_radius: How far from its end it may leave its path to run through to the next one, m; 0 stops.
        arguments: Velocity and acceleration, by name, where they are not those of the settings: m/s and
            m/s^2 of the tool, or rad/s and rad/s^2 (m) that no axis exceeds.
    """

    kind: MotionKind
    target: Target
    blend_radius: float
    arguments: Mapping[str, float]

    @classmethod
    def commanded(
        cls, robot: BaseRobotModel, kind: MotionKind, target: Target, settings: MotionSettings
    ) -> MotionPrimitive:
        """The primitive of a motion with its settings, the inverse of `settings`.

        Args:
            robot: The robot.
            kind: JOINT, LINE or CIRCLE; of others, JOINT_TO_POSE is a JOINT once its posture is known.
            target: See `PathPlanning.plan`; poses in the robot's base.
            settings: Those of the motion.

        Raises:
            InvalidInputError: a motion that is no primitive.
        """
        arc = kind is CIRCLE and isinstance(target, tuple) and len(target) == ARC_POSES
        if kind not in {JOINT, LINE} and not arc:
            raise InvalidInputError(
                f'{kind.title} is no motion primitive; valid are {JOINT.title}, {LINE.title}, and '
                f'{CIRCLE.title} with a point on the way and the end'
            )
        if kind.cartesian:
            arguments = {
                'velocity': settings.cartesian_speed,
                'acceleration': settings.cartesian_acceleration,
            }
            return cls(kind, target, settings.blend_zone, arguments)
        axes = robot.axes_data
        arguments = {
            'velocity': settings.speed_fraction * float(axes.velocity.max()),
            'acceleration': settings.acceleration_fraction * float(axes.acceleration.max()),
        }
        radius = settings.joint_blend_zone * _farthest(robot, np.asarray(target), settings)
        return cls(kind, target, min(radius, RANGES['blend_zone'][1]), arguments)

    def settings(self, robot: BaseRobotModel, modal: MotionSettings, *, last: bool) -> MotionSettings:
        """The settings to command it with.

        Args:
            robot: The robot.
            modal: What holds for all that the primitive does not say.
            last: Nothing follows that it could run through to.

        Raises:
            InvalidInputError: an argument that does not exist, or a value outside its range.
        """
        largest = RANGES['blend_zone'][1]
        if not 0.0 <= self.blend_radius <= largest:
            raise InvalidInputError(f'blend_radius = {self.blend_radius:.6g} m must be in [0, {largest:g}] m')
        radius = 0.0 if last else self.blend_radius
        changes: dict[str, Any] = {'blend_zone': 0.0, 'joint_blend_zone': 0.0}
        if self.kind.cartesian:
            changes['blend_zone'] = radius
            names = {'velocity': 'cartesian_speed', 'acceleration': 'cartesian_acceleration'}
            changes |= {names[quantity]: value for quantity, value in self._arguments()}
        else:
            changes['joint_blend_zone'] = self._joint_zone(robot, modal, radius)
            axes = robot.axes_data
            for quantity, value in self._arguments():
                highest = float(getattr(axes, quantity).max())
                name = 'speed_fraction' if quantity == 'velocity' else 'acceleration_fraction'
                changes[name] = usable_fraction(min(1.0, value / highest), f'{quantity} / {highest:.6g}')
        return replace(modal, **changes)

    def _arguments(self) -> list[tuple[str, float]]:
        for name, value in self.arguments.items():
            if name not in ARGUMENTS:
                valid = ' and '.join(ARGUMENTS)
                raise InvalidInputError(f'argument {name!r} is not known; valid are {valid}')
            if not (math.isfinite(value) and value > 0.0):
                raise InvalidInputError(f'{name} = {value:g} must be a number above 0')
        return list(self.arguments.items())

    def _joint_zone(self, robot: BaseRobotModel, modal: MotionSettings, radius: float) -> float:
        """The zone of the axes, rad (m), in which the tool is no farther than `radius` from the end.

        However the axes move, by the Jacobian at the end.
        """
        if radius == 0.0:
            return 0.0
        if self.kind is not JOINT:
            raise InvalidInputError(
                f'blend_radius = {radius:g} m of a joint motion needs joint_positions, not a pose'
            )
        q = robot.axes_data.check_position(np.asarray(self.target, dtype=np.float64), 'joint_positions')
        return min(radius / _farthest(robot, q, modal), RANGES['joint_blend_zone'][1])


def _farthest(robot: BaseRobotModel, q: Array, settings: MotionSettings) -> float:
    """How far the tool moves at most, m, if no axis moves by more than 1 rad (m) from `q`, (n,)."""
    J = robot.jacobian(q)
    arm = robot.direct_kinematics(q)[1] @ settings.tool_pose.r
    linear = J[:3] + np.cross(J[3:].T, arm).T
    return float(np.linalg.norm(linear, axis=0).sum())
