"""A car that speeds up, changes lanes twice and brakes: what a driver's head feels.

The path is the double lane change of P. Falcone, F. Borrelli, J. Asgari, H. E. Tseng and D. Hrovat,
Predictive Active Steering Control for Autonomous Vehicle Systems, IEEE Transactions on Control Systems
Technology 15, 2007: the lateral position as two hyperbolic tangents of the distance. The car is a point that
follows it with its nose along the path, and leans in proportion to its acceleration; its speeds and how it
leans are chosen here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core import Pose
from robots_core.blocks import VehicleMotion
from robots_core.orientation import rotation_vector
from robots_core.validation import Array

SHAPE = 2.4
STEPS = ((4.05, 25.0, 27.19), (5.7, 21.95, 56.46))  # m to the side, within m, from m on
STEP = 1e-3  # s, of the differences that give velocities and accelerations


@dataclass(frozen=True, kw_only=True)
class DoubleLaneChange:
    """The manoeuvre, from rest to rest.

    Attributes:
        speed: Of the lane change, m/s.
        speeding_up: Time until then, s.
        braking: Time to stop from there, s.
        rest: Time at rest before, s.
        rest_after: Time at rest at the end, s.
        way: Driven at that speed, m.
        roll: By which the body leans outwards, rad per m/s^2 to the side.
        pitch: By which it dips when it brakes, rad per m/s^2.
    """

    speed: float = 13.0
    speeding_up: float = 8.0
    braking: float = 5.0
    rest: float = 0.5
    rest_after: float = 4.5
    way: float = 95.0
    roll: float = np.radians(0.5)
    pitch: float = np.radians(0.2)

    @property
    def duration(self) -> float:
        """Of all, s."""
        moving = self.speeding_up + self.way / self.speed + self.braking
        return self.rest + moving + self.rest_after

    def motion(self, time: float) -> VehicleMotion:
        """What an inertial measurement unit at the driver's head measures, at a time in s."""
        before, now, after = (self._pose(time + step) for step in (-STEP, 0.0, STEP))
        acceleration = (before.r - 2.0 * now.r + after.r) / STEP**2
        angular_velocity = rotation_vector(before.T.T @ after.T) / (2.0 * STEP)
        return VehicleMotion.of_body(now.T, acceleration, angular_velocity)

    def _pose(self, time: float) -> Pose:
        """Of the head in the frame of the road: x along it, y to the left, z up."""
        before, now, after = (self._place(time + step) for step in (-STEP, 0.0, STEP))
        acceleration = (before - 2.0 * now + after) / STEP**2
        heading = np.arctan(_slope(now[0]))
        nose, left = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
        along, across = nose @ acceleration, left @ acceleration
        return Pose.from_angles([*now, 0.0], [heading, -self.pitch * along, self.roll * across])

    def _place(self, time: float) -> Array:
        x = self._distance(time)
        return np.array([x, _side(x)])

    def _distance(self, time: float) -> float:
        """Along the road, m; it speeds up and brakes by a squared sine, without a jerk at its ends."""
        t = time - self.rest
        steady = self.way / self.speed
        start = 0.5 * self.speed * self.speeding_up
        x = -start + _ramp(t, self.speeding_up) * self.speed
        x += self.speed * min(max(t - self.speeding_up, 0.0), steady)
        later = t - self.speeding_up - steady
        if later > 0.0:
            x += self.speed * (min(later, self.braking) - _ramp(later, self.braking))
        return x


def _ramp(time: float, duration: float) -> float:
    """Integral of a speed that grows from 0 to 1 by (1 - cos) of the acceleration, s."""
    t = min(max(time, 0.0), duration)
    w = 2.0 * np.pi / duration
    return float(t**2 / (2.0 * duration) + (np.cos(w * t) - 1.0) / (duration * w**2))


def _side(x: float) -> float:
    (a, b, c), (d, e, f) = STEPS
    one, two = SHAPE / b * (x - c) - SHAPE / 2, SHAPE / e * (x - f) - SHAPE / 2
    return float(0.5 * a * (1.0 + np.tanh(one)) - 0.5 * d * (1.0 + np.tanh(two)))


def _slope(x: float) -> float:
    total = 0.0
    for sign, (a, b, c) in zip((1.0, -1.0), STEPS, strict=True):
        total += sign * 0.5 * a * SHAPE / b / np.cosh(SHAPE / b * (x - c) - SHAPE / 2) ** 2
    return total
