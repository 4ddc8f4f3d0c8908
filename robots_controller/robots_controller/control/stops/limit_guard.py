"""LimitGuard: the last check before a reference leaves the controller."""

import numpy as np

from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

# Second differences of float64 positions of a few rad over (1 ms)^2 are off by about 1e-9 rad/s^2.
RELATIVE_TOLERANCE = 1e-6


class LimitGuard:
    """Checks every reference against position, velocity and acceleration limits.

    Velocity and acceleration are checked twice: as the reference states them, and as the difference to
    the references before, which is what acts on a drive.

    Args:
        axes: The limits.
        period: Time between two references, s.
    """

    def __init__(self, axes: AxesData, *, period: float) -> None:
        self._axes = axes
        self._period = period
        n = axes.num_axes
        rates = np.concatenate([axes.velocity, axes.acceleration]) * (1.0 + RELATIVE_TOLERANCE)
        self._high = np.concatenate([axes.upper + RELATIVE_TOLERANCE, rates, rates])
        self._low = np.concatenate([axes.lower - RELATIVE_TOLERANCE, -rates, -rates])
        self._values = np.zeros(5 * n)
        self._last_position = np.zeros(n)
        self._last_velocity = np.zeros(n)

    def reset(self, position: Array) -> None:
        """Stand still at `position` (n,)."""
        self._last_position = position.copy()
        self._last_velocity = np.zeros_like(position)

    def check(self, reference: Array) -> str | None:
        """Check the next reference, (3, n): position, velocity, acceleration.

        Returns:
            None, or the limit that it breaks, for a person. Only a reference that passes becomes the
            one before of the next check.
        """
        n = self._axes.num_axes
        velocity = (reference[0] - self._last_position) / self._period
        values = self._values
        values[: 3 * n] = reference.ravel()
        values[3 * n : 4 * n] = velocity
        values[4 * n :] = (velocity - self._last_velocity) / self._period
        # NaN compares false both ways, so that it does not pass.
        inside = (values <= self._high) & (values >= self._low)
        if not inside.all():
            return self._describe(int(np.flatnonzero(~inside)[0]))
        self._last_position = reference[0].copy()
        self._last_velocity = velocity
        return None

    def passing(self, references: Array) -> int:
        """How many of the next references, (k, 3, n), pass `check` one after the other."""
        velocity = np.diff(references[:, 0], axis=0, prepend=self._last_position[None]) / self._period
        acceleration = np.diff(velocity, axis=0, prepend=self._last_velocity[None]) / self._period
        values = np.concatenate([*np.moveaxis(references, 1, 0), velocity, acceleration], axis=1)
        inside = ((values <= self._high) & (values >= self._low)).all(axis=1)
        return len(references) if inside.all() else int(np.argmin(inside))

    def pass_over(self, references: Array) -> None:
        """Take references (k, 3, n) of which it is known that they pass."""
        before = references[-2, 0] if len(references) > 1 else self._last_position
        self._last_position = references[-1, 0].copy()
        self._last_velocity = (self._last_position - before) / self._period

    def _describe(self, index: int) -> str:
        n = self._axes.num_axes
        axis = index % n
        quantity = ('position', 'velocity', 'acceleration', 'velocity', 'acceleration')[index // n]
        unit = self._axes.unit(axis, quantity)
        return (
            f'{quantity} of {self._axes.names[axis]} is {self._values[index]:.6g} {unit}, '
            f'allowed is [{self._low[index]:.6g}, {self._high[index]:.6g}] {unit}'
        )
