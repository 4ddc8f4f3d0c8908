"""MotionSamples: positions, speeds, accelerations and torques of a recorded motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError, MeasurementError
from robots_core.validation import Array, read_only

WINDOW: Final = 0.2  # s
DEGREE: Final = 3
FEWEST_IN_WINDOW: Final = 8


@dataclass(frozen=True, eq=False)
class MotionSamples:
    """Samples of a motion, all of the same shape (k, n), read-only.

    Attributes:
        q: Joint positions, rad (m).
        q_dot: Velocities, rad/s (m/s).
        q_ddot: Accelerations, rad/s^2 (m/s^2).
        tau: Torques of the motors, at the joints, N m (N).

    Raises:
        InvalidInputError: other shapes, or a value that is not finite.
    """

    q: Array
    q_dot: Array
    q_ddot: Array
    tau: Array

    def __post_init__(self) -> None:
        shape = np.shape(self.q)
        for name in ('q', 'q_dot', 'q_ddot', 'tau'):
            values = read_only(getattr(self, name))
            if values.ndim != 2 or values.shape != shape:
                raise InvalidInputError(f'{name} has shape {values.shape}; all need the same (k, n)')
            if not np.isfinite(values).all():
                raise InvalidInputError(f'{name} has a value that is not a finite number')
            object.__setattr__(self, name, values)

    @classmethod
    def from_recording(cls, time: ArrayLike, q: ArrayLike, tau: ArrayLike) -> MotionSamples:
        """Samples from recorded positions and torques, which may be noisy.

        A polynomial of degree 3 over `WINDOW` is fitted around every sample, to positions and torques alike,
        so that both are delayed and smoothed equally (Savitzky and Golay 1964, for any times). Samples are
        half a window apart.

        Args:
            time: (m,) s, ascending.
            q: (m, n) rad (m).
            tau: (m, n) N m (N).

        Raises:
            InvalidInputError: other shapes, values that are not finite, or times that do not ascend.
            MeasurementError: nowhere are there enough values in a window.
        """
        half = 0.5 * WINDOW
        t, values = _checked(time, q, tau)
        samples = [
            _centre(t[first:last] - middle, values[:, first:last])
            for middle in np.arange(t[0] + half, t[-1] - half, half)
            for first, last in [np.searchsorted(t, (middle - half, middle + half))]
            if last - first >= FEWEST_IN_WINDOW
        ]
        if not samples:
            raise MeasurementError(
                f'{len(t)} values in {t[-1] - t[0]:.3g} s are no recording of a motion; needed are '
                f'{FEWEST_IN_WINDOW} in {WINDOW:g} s',
                key='no_motion',
                count=len(t),
                duration=float(t[-1] - t[0]),
                fewest=FEWEST_IN_WINDOW,
                window=WINDOW,
            )
        return cls(*np.moveaxis(np.array(samples), 1, 0))


def _checked(time: ArrayLike, q: ArrayLike, tau: ArrayLike) -> tuple[Array, Array]:
    t = np.asarray(time, dtype=np.float64)
    if t.ndim != 1 or len(t) < 2 or not np.isfinite(t).all() or not (np.diff(t) > 0.0).all():
        raise InvalidInputError('time must be at least 2 finite numbers that ascend')
    values = np.asarray(q, dtype=np.float64), np.asarray(tau, dtype=np.float64)
    for name, one in zip(('q', 'tau'), values, strict=True):
        if one.ndim != 2 or one.shape != values[0].shape or len(one) != len(t):
            raise InvalidInputError(f'{name} has shape {one.shape}; it needs {len(t)} rows, as time has')
    return t, np.array(values)


def _centre(t: Array, values: Array) -> Array:
    """Position, velocity, acceleration and torque at t = 0, (4, n), of values (2, m, n)."""
    powers = np.vander(t, DEGREE + 1, increasing=True)
    position, torque = (np.linalg.lstsq(powers, one)[0] for one in values)
    return np.array([position[0], position[1], 2.0 * position[2], torque[0]])
