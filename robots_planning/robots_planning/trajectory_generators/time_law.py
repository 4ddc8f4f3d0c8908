"""TimeLaw: from path speeds on a grid to a smooth s(t)."""

from __future__ import annotations

import numpy as np

from robots_core.validation import Array


class TimeLaw:
    """s(t) with piecewise constant s_ddot, convolved twice with a rectangle of half the window.

    The convolution makes s_ddot continuous, with a continuous derivative's area of at most 2 / window, keeps
    rest at both ends, and lengthens the motion by the window.

    Args:
        s: Path grid, (m,), from 0 to 1.
        speed_squared: s_dot^2 at the grid points, (m,); 0 at both ends, above 0 in between.
        window: s.
    """

    def __init__(self, s: Array, speed_squared: Array, window: float) -> None:
        speed = np.sqrt(speed_squared)
        steps = 2.0 * np.diff(s) / (speed[:-1] + speed[1:])
        self._t = np.concatenate([[0.0], np.cumsum(steps)])
        self._s, self._speed = s, speed
        self._acceleration = np.append(np.diff(speed) / steps, 0.0)
        self._window = window
        # First and second integrals of s over time at the grid points.
        a, v, h = self._acceleration[:-1], speed[:-1], steps
        once = h * (s[:-1] + h * (v / 2.0 + h * a / 6.0))
        self._once = np.concatenate([[0.0], np.cumsum(once)])
        twice = h * (self._once[:-1] + h * (s[:-1] / 2.0 + h * (v / 6.0 + h * a / 24.0)))
        self._twice = np.concatenate([[0.0], np.cumsum(twice)])

    @property
    def duration(self) -> float:
        """Length, s, with the window."""
        return float(self._t[-1]) + self._window

    def s_of(self, t: Array) -> tuple[Array, Array, Array]:
        """s, s_dot and s_ddot at times `t` (m,), each (m,)."""
        half = 0.5 * self._window
        results = [self._integrals(t - shift) for shift in (0.0, half, 2.0 * half)]
        # Twice the same rectangle: second differences of the integrals.
        smooth = [(new - 2.0 * middle + old) / half**2 for new, middle, old in zip(*results, strict=True)]
        return np.clip(smooth[0], 0.0, 1.0), smooth[1], smooth[2]

    def grid_times(self) -> Array:
        """When the smooth law is about at each grid point, (m,) s."""
        return self._t + 0.5 * self._window

    def _integrals(self, t: Array) -> tuple[Array, Array, Array]:
        """Second and first integral of s, and s, at `t`; at rest before and after."""
        clipped = np.clip(t, 0.0, self._t[-1])
        i = np.clip(np.searchsorted(self._t, clipped, side='right') - 1, 0, len(self._t) - 2)
        x = clipped - self._t[i]
        after = np.maximum(t - self._t[-1], 0.0)
        s0, v, a = self._s[i], self._speed[i], self._acceleration[i]
        s = s0 + x * (v + x * a / 2.0)
        once = self._once[i] + x * (s0 + x * (v / 2.0 + x * a / 6.0))
        twice = self._twice[i] + x * (self._once[i] + x * (s0 / 2.0 + x * (v / 6.0 + x * a / 24.0)))
        return twice + after * (once + after * s / 2.0), once + after * s, s
