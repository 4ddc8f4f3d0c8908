"""Trajectory: joint positions, velocities and accelerations over time."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_core.errors import InvalidInputError
from robots_core.kernels.compiled import compiled
from robots_core.validation import FLOAT64, Array
from robots_planning.timing.quintic import quintic_coefficients, quintics_at

FIELDS: Final = ('time', 'position', 'velocity', 'acceleration')


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Points of a motion; between two points it is the quintic through both (as in ros2_control).

    Attributes:
        time: (m,) s, from 0, strictly increasing; m >= 2.
        position: (m, n) rad (m).
        velocity: (m, n) rad/s (m/s).
        acceleration: (m, n) rad/s^2 (m/s^2).

    Raises:
        InvalidInputError: shapes that do not match, values that are not finite, or time that does not
            start at 0 and increase.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    def __post_init__(self) -> None:
        for name in FIELDS:
            values = getattr(self, name)
            if _frozen(values):
                continue
            # Compiled code is made for one layout of memory; another would be compiled again, for seconds.
            values = np.array(values, dtype=np.float64, order='C')
            values.flags.writeable = False
            object.__setattr__(self, name, values)
        m, shape = self.time.shape[0] if self.time.ndim == 1 else 0, self.position.shape
        if m < 2:
            raise InvalidInputError(
                f'a trajectory needs at least 2 points, got time of shape {self.time.shape}'
            )
        if (
            len(shape) != 2
            or shape[0] != m
            or self.velocity.shape != shape
            or self.acceleration.shape != shape
        ):
            raise InvalidInputError(
                f'position {shape}, velocity {self.velocity.shape} and acceleration '
                f'{self.acceleration.shape} must all be ({m}, n), one row per time'
            )
        if not _sound(*self.points):
            for name in FIELDS:
                if not np.isfinite(getattr(self, name)).all():
                    raise InvalidInputError(f'trajectory {name} holds a value that is not finite')
            raise InvalidInputError('trajectory time must start at 0 and increase from point to point')

    @property
    def points(self) -> tuple[Array, Array, Array, Array]:
        """Times, positions, velocities and accelerations."""
        return self.time, self.position, self.velocity, self.acceleration

    @cached_property
    def coefficients(self) -> Array:
        """(m - 1, 6, n): polynomial per interval, in powers of the time since the interval's start, s.

        Not read-only, for which code would be compiled once more.
        """
        coefficients = np.empty((len(self.time) - 1, 6, self.num_axes))
        quintic_coefficients(*self.points, coefficients)
        return coefficients

    @staticmethod
    def message_times(time: Array) -> Array:
        """Times (m,) rounded to nanoseconds, which is what messages hold.

        Points planned at such times keep their acceleration when they travel; rounding afterwards would
        change the second difference of positions by up to a nanosecond of motion over the square of a step.
        """
        return np.round(time * 1e9) / 1e9

    def points_of_message(self, join_time: float = 0.0) -> tuple[NDArray[np.int64], Array]:
        """Times (m,), ns, and position, velocity and acceleration, (3, m, n), of the points of its message.

        Args:
            join_time: Time of the first one: where it continues from another trajectory, s.
        """
        times = np.round(self.time * 1e9).astype(np.int64) + round(join_time * 1e9)
        return times, np.array(self.points[1:])

    @property
    def num_axes(self) -> int:
        """Number of axes n."""
        return int(self.position.shape[1])

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return float(self.time[-1])

    def sample(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration at times `t`; before the start and after the end it rests.

        Args:
            t: Times, s, of any shape (...).

        Returns:
            Three arrays (..., n).
        """
        times = np.asarray(t, dtype=np.float64)
        q, q_dot, q_ddot = self._states(times)
        outside = ((times < 0.0) | (times > self.duration))[..., None]
        return q, np.where(outside, 0.0, q_dot), np.where(outside, 0.0, q_ddot)

    def sample_position(self, t: Array) -> Array:
        """The positions of `sample` alone, (..., n)."""
        return self._states(t)[0]

    def _states(self, t: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration; before the start and after the end, those there."""
        states = [np.empty((t.size, self.num_axes)) for _ in range(3)]
        quintics_at(self.time, self.coefficients, np.array(t.ravel()), *states)
        q, q_dot, q_ddot = (values.reshape(*t.shape, self.num_axes) for values in states)
        return q, q_dot, q_ddot

    def acceleration_extremes(self) -> tuple[Array, Array, Array]:
        """Where acceleration or jerk can be largest: ends and inner extremes of every interval, exactly.

        Returns:
            Times, s, and absolute acceleration and jerk there, (k, n) each; k is some multiple of m - 1.
        """
        h = np.diff(self.time)[:, None]
        c2, c3, c4, c5 = (self.coefficients[:, power] for power in (2, 3, 4, 5))
        # Jerk 6 c3 + 24 c4 x + 60 c5 x^2 is zero at an extreme of acceleration, and extreme at its vertex.
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            root = np.sqrt(np.maximum(c4**2 - 2.5 * c3 * c5, 0.0))
            inner = [(-2.0 * c4 - 2.0 * root) / (10.0 * c5), (-2.0 * c4 + 2.0 * root) / (10.0 * c5)]
            inner += [-c4 / (5.0 * c5), -c3 / (4.0 * c4)]
        x = np.stack([np.zeros_like(c3), np.broadcast_to(h, c3.shape), *inner])
        x = np.clip(np.where(np.isfinite(x), x, 0.0), 0.0, h)
        acceleration = np.abs(2.0 * c2 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5)))
        jerk = np.abs(6.0 * c3 + x * (24.0 * c4 + x * 60.0 * c5))
        times = self.time[:-1, None] + x
        n = self.num_axes
        return times.reshape(-1, n), acceleration.reshape(-1, n), jerk.reshape(-1, n)


def one_after_another(trajectories: Sequence[Trajectory]) -> Trajectory:
    """Motions that each begin where the one before ends, as one."""
    first = trajectories[0]
    if len(trajectories) == 1:
        return first
    time, rows = [first.time], [[*first.points[1:]]]
    for following in trajectories[1:]:
        time.append(Trajectory.message_times(time[-1][-1] + following.time[1:]))
        rows.append([row[1:] for row in following.points[1:]])
    return Trajectory(np.concatenate(time), *(np.concatenate(parts) for parts in zip(*rows, strict=True)))


def _frozen(values: object) -> bool:
    """A read-only array that compiled code can take, so that no copy is needed."""
    if type(values) is not np.ndarray or values.dtype is not FLOAT64:
        return False
    flags = values.flags
    return flags.c_contiguous and not flags.writeable and not isinstance(values.base, np.ndarray)


@compiled()
def _sound(time: Array, position: Array, velocity: Array, acceleration: Array) -> bool:
    """Time starts at 0 and increases, and all is finite."""
    if time[0] != 0.0 or not isfinite(time[-1]):
        return False
    for i in range(time.size - 1):
        if not time[i + 1] > time[i]:
            return False
    for values in (position, velocity, acceleration):
        for row in range(values.shape[0]):
            for column in range(values.shape[1]):
                if not isfinite(values[row, column]):
                    return False
    return True
