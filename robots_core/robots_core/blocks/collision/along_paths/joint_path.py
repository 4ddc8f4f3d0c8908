"""JointPath: joint positions over time, with bounds on the displacement between any two times."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.validation import Array, read_only

# Bounds by control points are the tighter the shorter the pieces are.
LONGEST_PIECE = 0.02  # s
LONGEST_PATH = 3600.0  # s
LARGEST = 1e9  # s, rad (m) and their derivatives


@dataclass(frozen=True, eq=False)
class JointPath:
    """A motion in joint space for collision checks.

    Between its points it is the quintic through both, as trajectories are in ros2_control and here.

    Attributes:
        time: (m,) s, increasing; m >= 2.
        position: (m, n) rad (m).
        velocity: (m, n) rad/s (m/s).
        acceleration: (m, n) rad/s^2 (m/s^2).

    Raises:
        InvalidInputError: shapes that do not match, values that are not finite or past `LARGEST`,
            time that does not increase, or more than `LONGEST_PATH` of it.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    _breaks: Array = field(init=False, repr=False)  # of the short pieces
    _points: Array = field(init=False, repr=False)  # their control points
    _travel: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ('time', 'position', 'velocity', 'acceleration'):
            values = read_only(getattr(self, name))
            if not (np.abs(values) <= LARGEST).all():  # also true for NaN
                raise InvalidInputError(f'path {name} holds a value that is no number within +-{LARGEST:g}')
            object.__setattr__(self, name, values)
        m = self.time.size
        shape = self.position.shape
        if self.time.shape != (m,) or m < 2 or not (np.diff(self.time) > 0.0).all():
            raise InvalidInputError('a path needs at least 2 points at increasing times')
        if self.end - self.start > LONGEST_PATH:
            raise InvalidInputError(
                f'the path takes {self.end - self.start:.6g} s; allowed are {LONGEST_PATH:g} s'
            )
        if len(shape) != 2 or {shape, self.velocity.shape, self.acceleration.shape} != {(m, shape[-1])}:
            raise InvalidInputError(
                f'position {shape}, velocity {self.velocity.shape} and acceleration '
                f'{self.acceleration.shape} must all be ({m}, n), one row per time'
            )
        self._make_curve()

    def _make_curve(self) -> None:
        curve = _control_points(self.time, self.position, self.velocity, self.acceleration)
        # Every piece is cut into short ones with their own control points.
        pieces = np.maximum(np.ceil(np.diff(self.time) / LONGEST_PIECE - 1e-9).astype(int), 1)
        time, points = self.time, curve
        if (pieces > 1).any():
            steps = np.repeat(np.diff(self.time) / pieces, pieces)
            first = np.append(0, np.cumsum(pieces))
            number = np.arange(first[-1]) - np.repeat(first[:-1], pieces)
            time = np.append(number * steps + np.repeat(self.time[:-1], pieces), self.time[-1])
            states = _states(curve, self.time, time)
            for order, given in enumerate((self.position, self.velocity, self.acceleration)):
                # Where the acceleration jumps at a point, the given value is used.
                states[order][first] = given
            points = _control_points(time, *states)
        # Bernstein polynomials and their derivatives lie in the convex hull of their control points.
        steps = np.abs(np.diff(points, axis=0)).max(axis=0) * 5.0
        travel = np.concatenate([np.zeros((1, points.shape[2])), np.cumsum(steps, axis=0)])
        object.__setattr__(self, '_breaks', time)
        object.__setattr__(self, '_points', points)
        object.__setattr__(self, '_travel', travel)

    @classmethod
    def straight(cls, start: ArrayLike, end: ArrayLike) -> JointPath:
        """The straight line between two joint positions (n,), at constant speed within 1 s."""
        position = np.array([start, end], dtype=np.float64)
        velocity = np.repeat(position[1:] - position[:1], 2, axis=0)
        return cls(np.array([0.0, 1.0]), position, velocity, np.zeros_like(position))

    @property
    def start(self) -> float:
        """First time, s."""
        return float(self.time[0])

    @property
    def end(self) -> float:
        """Last time, s."""
        return float(self.time[-1])

    def sample(self, t: float) -> Array:
        """Joint positions (n,) at a time between start and end."""
        breaks = self._breaks
        i = min(max(int(breaks.searchsorted(t, 'right')) - 1, 0), len(breaks) - 2)
        s = float((t - breaks[i]) / (breaks[i + 1] - breaks[i]))
        u = 1.0 - s
        bernstein = (
            u**5,
            5.0 * u**4 * s,
            10.0 * u**3 * s**2,
            10.0 * u**2 * s**3,
            5.0 * u * s**4,
            s**5,
        )
        q: Array = np.array(bernstein) @ self._points[:, i]
        return q

    def turn(self, low: float, middle: float, high: float) -> Array:
        """Bounds on the axes' displacements from `middle`, between times `low` and `high`; (n,) rad (m)."""
        at = np.array([low, middle, high])
        x = self._breaks
        index = np.clip(np.searchsorted(x, at, side='right') - 1, 0, len(x) - 2)
        part = ((at - x[index]) / (x[index + 1] - x[index]))[:, None]
        travel = (1.0 - part) * self._travel[index] + part * self._travel[index + 1]
        farthest: Array = np.maximum(travel[1] - travel[0], travel[2] - travel[1])
        return farthest

    def fastest(self) -> Array:
        """Bounds on the axes' speeds, (n,) rad/s (m/s): of control points, a little above what they reach."""
        speeds: Array = (np.diff(self._travel, axis=0) / np.diff(self._breaks)[:, None]).max(axis=0)
        return speeds

    def fraction(self, t: float) -> float:
        """Part of the time that has passed, 0..1."""
        return (t - self.start) / (self.end - self.start)


def _states(points: Array, breaks: Array, at: Array) -> list[Array]:
    """Positions, velocities and accelerations at times (k,), (k, n) each, of control points (6, m, n)."""
    index = np.clip(np.searchsorted(breaks, at, side='right') - 1, 0, len(breaks) - 2)
    h = np.diff(breaks)[index][:, None]
    s = (at - breaks[index])[:, None] / h
    states, control = [], points[:, index]
    for _ in range(3):
        inner = control
        while len(inner) > 1:  # de Casteljau
            inner = (1.0 - s) * inner[:-1] + s * inner[1:]
        states.append(inner[0])
        control = (len(control) - 1) * np.diff(control, axis=0) / h
    return states


def _control_points(time: Array, position: Array, velocity: Array, acceleration: Array) -> Array:
    """Control points (6, m - 1, n) of the quintics through all points."""
    h = np.diff(time)[:, None]
    step, bend = velocity * 0.2, acceleration * 0.05
    return np.stack(
        [
            position[:-1],
            position[:-1] + h * step[:-1],
            position[:-1] + 2.0 * h * step[:-1] + h**2 * bend[:-1],
            position[1:] - 2.0 * h * step[1:] + h**2 * bend[1:],
            position[1:] - h * step[1:],
            position[1:],
        ]
    )
