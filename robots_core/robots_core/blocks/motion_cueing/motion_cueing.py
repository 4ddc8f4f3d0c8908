"""MotionCueing: the classical washout filter, from a vehicle's motion to that of a simulator's cabin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import asin, cos, sin, tan

import numpy as np

from robots_core.blocks.following.axis_following import AxisFollowing
from robots_core.blocks.motion_cueing.cabin_envelope import DIRECTIONS, UNITS, CabinEnvelope
from robots_core.blocks.motion_cueing.vehicle_motion import GRAVITY, VehicleMotion
from robots_core.blocks.motion_cueing.washout_filters import (
    rotation_filters,
    tilt_filters,
    translation_filters,
)
from robots_core.blocks.motion_cueing.washout_settings import WashoutSettings
from robots_core.orientation import orientation_from_angles
from robots_core.pose import Pose
from robots_core.validation import Array, positive, read_only

# A cabin this far from what the washout requests is held back by its envelope.
HELD_BACK = (1e-3, 1e-3)  # m, rad
UP = np.array([0.0, 0.0, GRAVITY])


@dataclass(frozen=True, eq=False)
class CueingStep:
    """Motion of the cabin at the end of a period. Arrays are read-only.

    Columns of `cabin` and `washout` are surge, sway, heave (m) and roll, pitch, yaw (rad) from the middle;
    rows are positions, velocities, and (of the cabin) accelerations during the period.

    Attributes:
        cabin: What the cabin does, (3, 6): always inside its envelope.
        washout: What the filter requests without the envelope, (2, 6).
        wanted: What the person would feel if the cabin gave all of it: the scaled motion of the vehicle.
        felt: What the person feels in the cabin: specific force and angular velocity in its frame.
        limits: What is limited, with value and bound; empty where the filter alone decides.
    """

    cabin: Array
    washout: Array
    wanted: VehicleMotion
    felt: VehicleMotion
    limits: tuple[str, ...]

    @property
    def pose(self) -> Pose:
        """Pose of the person's head, seen from the middle of the cabin's motion."""
        return Pose(self.cabin[0, :3], attitude(self.cabin[0, 3:]))

    @property
    def twist(self) -> Array:
        """Velocity (m/s) and angular velocity (rad/s) of the head, (6,), in the frame of the middle."""
        return np.concatenate([self.cabin[1, :3], self.pose.T @ self.felt.angular_velocity])


class MotionCueing:
    """Moves a cabin so that a person in it feels what a vehicle does, as far as its envelope allows.

    The classical washout algorithm has these parts:

    - *scaling and limiting* of specific force and angular velocity;
    - *translation*: the specific force is turned into the inertial frame by the attitude of the cabin,
      gravity is added, and the acceleration that remains goes through a high-pass and is integrated to a
      position;
    - *tilt coordination*: what a low-pass leaves of the specific force is given by tilting the cabin in
      gravity, no faster than the tilt rate;
    - *rotation*: the angular velocity becomes rates of roll, pitch and yaw, goes through a high-pass and is
      integrated to angles, to which those of the tilt are added.

    Because the attitude turns the force before the high-pass, the translation only gives what tilting does
    not give yet. The cabin then follows the filter inside its envelope (`AxisFollowing`), able to brake
    before a bound at any time. Without samples for `timeout` the input fades to that of a vehicle at rest,
    which brings the cabin to the middle.

    Structure after L. D. Reid and M. A. Nahon, Flight Simulation Motion-Base Drive Algorithms: Part 1,
    Developing and Testing the Equations, UTIAS Report 296, University of Toronto, 1985; M. A. Nahon and
    L. D. Reid, Simulator Motion-Drive Algorithms: A Designer's Perspective, Journal of Guidance, Control, and
    Dynamics 13, 1990; and R. J. Telban and F. M. Cardullo, Motion Cueing Algorithm Development:
    Human-Centered Linear and Nonlinear Approaches, NASA/CR-2005-213747, 2005. Here the axes are those of
    REP 103 (z up), the tilt angles are exact and not small-angle approximations, and the envelope is an
    addition.

    An instance keeps the state of the motion: use one per thread.

    Args:
        settings: Parameters of the filter.
        envelope: Of the cabin.
        dt: Period, s.

    Raises:
        InvalidInputError: a period that is not positive.
    """

    def __init__(self, settings: WashoutSettings, envelope: CabinEnvelope, dt: float) -> None:
        self.settings, self.envelope = settings, envelope
        self.dt = positive(dt, 'dt', 's')
        self._reach = np.array(envelope.reach)
        self._follow = AxisFollowing(envelope.axes_data, dt)
        self.reset()

    def reset(self) -> None:
        """Start again with a cabin that stands in the middle."""
        s = self.settings
        self._translation = translation_filters(
            s.translation_frequency, s.translation_damping, s.return_frequency, self.dt
        )
        self._rotation = rotation_filters(s.rotation_frequency, s.rotation_damping, self.dt)
        self._low_pass = tilt_filters(s.tilt_frequency, s.tilt_damping, self.dt)
        self._tilt = np.zeros(3)
        self._attitude = np.zeros(3)
        self._cabin = np.zeros((3, 6))
        self._last = VehicleMotion.at_rest()
        self._missed, self._freshness = 0, 1.0

    def step(self, motion: VehicleMotion | None) -> CueingStep:
        """Motion of the cabin at the next sample.

        Args:
            motion: Of the vehicle at that time; None if no sample of it has come.
        """
        limits: list[str] = []
        wanted = self._scaled(self._input(motion, limits), limits)
        tilt = self._coordinate(wanted.specific_force, limits)
        angles = tilt + self._rotation.step(_angle_rates(self._attitude, wanted.angular_velocity))
        # Beyond the envelope the cabin does not have that attitude.
        self._attitude = np.minimum(np.maximum(angles[0], -self._reach[3:]), self._reach[3:])
        acceleration = attitude(self._attitude) @ wanted.specific_force - UP
        washout = np.hstack([self._translation.step(acceleration)[:2], angles])
        self._cabin = self._follow.step(self._cabin[0], self._cabin[1], washout[0], washout[1])
        limits += _held_back(washout[0], self._cabin[0], self._reach)
        return CueingStep(
            read_only(self._cabin), read_only(washout), wanted, _felt(self._cabin), tuple(limits)
        )

    def _input(self, motion: VehicleMotion | None, limits: list[str]) -> VehicleMotion:
        """The newest sample, faded to rest while none comes and back when they come again."""
        if motion is not None:
            self._last, self._missed = motion, 0
        else:
            self._missed += 1
        s = self.settings
        age = self._missed * self.dt
        fresh = age <= s.timeout
        change = self.dt / s.fade_time
        self._freshness = min(self._freshness + change, 1.0) if fresh else max(self._freshness - change, 0.0)
        if not fresh:
            limits.append(f'no motion of the vehicle for {age:.3g} s: the cabin returns to its middle')
        force = UP + self._freshness * (self._last.specific_force - UP)
        return VehicleMotion(force, self._freshness * self._last.angular_velocity)

    def _scaled(self, motion: VehicleMotion, limits: list[str]) -> VehicleMotion:
        s = self.settings
        force = _limited(motion.specific_force - UP, s.force_limit, 'specific force', 'm/s^2', limits)
        rate = _limited(motion.angular_velocity, s.rate_limit, 'angular velocity', 'rad/s', limits)
        return VehicleMotion(UP + np.array(s.force_scale) * force, np.array(s.rate_scale) * rate)

    def _coordinate(self, force: Array, limits: list[str]) -> Array:
        """Roll, pitch and yaw of the tilt, and their mean velocities over the period, (2, 3)."""
        s = self.settings
        # On single numbers numpy's functions take several times longer than those of Python.
        x, y = (self._low_pass.step(force[:2])[0] / GRAVITY).tolist()
        largest = sin(s.largest_tilt)
        # A cabin with these angles feels (-g sin pitch, g cos pitch sin roll, ...).
        pitch = -asin(_within(x, largest))
        roll = asin(_within(y / cos(pitch), largest))
        for name, share in (('pitch', x), ('roll', y)):
            if abs(share) > largest:
                limits.append(f'tilt of {name} is limited to {s.largest_tilt:.3g} rad')
        most = s.tilt_rate * self.dt
        missing = [wanted - now for wanted, now in zip((roll, pitch, 0.0), self._tilt.tolist(), strict=True)]
        for name, way in zip(DIRECTIONS[3:], missing, strict=True):
            if abs(way) > most:
                limits.append(f'tilt of {name} is limited to {s.tilt_rate:.3g} rad/s')
        change = np.array([_within(way, most) for way in missing])
        self._tilt = self._tilt + change
        return np.array([self._tilt, change / self.dt])


def _within(value: float, bound: float) -> float:
    return min(max(value, -bound), bound)


def attitude(angles: Array) -> Array:
    """Orientation (3, 3), cabin to inertial frame, of roll, pitch and yaw (3,) rad."""
    return orientation_from_angles(angles[::-1], 'zyx')


def _limited(values: Array, bounds: Sequence[float], name: str, unit: str, limits: list[str]) -> Array:
    limits += [
        f'{name} {axis} = {value:.3g} {unit} is beyond {bound:.3g} {unit}'
        for axis, value, bound in zip('xyz', values, bounds, strict=True)
        if abs(value) > bound
    ]
    most = np.array(bounds)
    held: Array = np.minimum(np.maximum(values, -most), most)
    return held


def _held_back(washout: Array, cabin: Array, reach: Array) -> list[str]:
    """How the envelope holds the cabin back from what the washout requests, by direction."""
    found = []
    for index, (direction, unit) in enumerate(zip(DIRECTIONS, UNITS, strict=True)):
        asked, given, bound = washout[index], cabin[index], reach[index]
        if abs(asked) > bound:
            found.append(f'{direction} of {asked:.3g} {unit} is beyond {bound:.3g} {unit}')
        elif abs(asked - given) > HELD_BACK[index // 3]:
            found.append(
                f'{direction} is {abs(asked - given):.3g} {unit} behind: limited in speed or acceleration'
            )
    return found


def _angle_rates(angles: Array, angular_velocity: Array) -> Array:
    """Rates of roll, pitch and yaw (3,) of an angular velocity (3,) in the cabin's frame, rad/s."""
    roll, pitch, _ = angles.tolist()
    p, q, r = angular_velocity.tolist()
    across = q * sin(roll) + r * cos(roll)
    return np.array([p + across * tan(pitch), q * cos(roll) - r * sin(roll), across / cos(pitch)])


def _angular_velocity(angles: Array, rates: Array) -> Array:
    """Angular velocity (3,) in the cabin's frame of rates of roll, pitch and yaw, rad/s."""
    roll, pitch, _ = angles.tolist()
    d_roll, d_pitch, d_yaw = rates.tolist()
    return np.array(
        [
            d_roll - d_yaw * sin(pitch),
            d_pitch * cos(roll) + d_yaw * sin(roll) * cos(pitch),
            d_yaw * cos(roll) * cos(pitch) - d_pitch * sin(roll),
        ]
    )


def _felt(cabin: Array) -> VehicleMotion:
    """What a person feels in a cabin (3, 6): its acceleration is the mean of the period."""
    angles = cabin[0, 3:]
    return VehicleMotion.of_body(attitude(angles), cabin[2, :3], _angular_velocity(angles, cabin[1, 3:]))
