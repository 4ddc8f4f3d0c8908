"""PathSpeed: how fast the path time runs, for override, pause and stop on the path."""

from collections.abc import Callable

import numpy as np

from robots_core.validation import Array, positive

# Halvings of a change of speed that the limits do not allow; 2^-10 of it is below what matters.
BISECTIONS = 10
# Second differences of float64 positions over one period are exact to about 1e-9 of a limit.
ROUNDING = 1e-8


class PathSpeed:
    """Path-time law with speeds between 0 and 1 that keeps every axis' acceleration limit.

    A path that keeps its acceleration limits at full speed keeps them at any constant lower speed, so
    going on as before is always allowed. A change of speed is made as fast as the second difference of
    the sampled positions stays inside the limits (the idea of Dahl and Nielsen 1990, path speed control
    under torque limits, on samples and with accelerations in the place of torques).

    Args:
        acceleration: Acceleration limits, (n,), rad/s^2.
        period: Time between two samples, s.
        ramp_time: Shortest time from standstill to full path speed, s.
    """

    def __init__(self, acceleration: Array, *, period: float, ramp_time: float) -> None:
        self._period = positive(period, 'period', 's')
        self._largest = acceleration * period**2 * (1.0 + ROUNDING)
        self._ramp = period**2 / positive(ramp_time, 'ramp_time', 's')
        self._advance = self._end = period
        self._change = self._gain = 0.0
        self.hurry = False
        """Change the speed as fast as the limits permit, whatever the ramp time."""

    @property
    def speed(self) -> float:
        """Path time per time, 0..1; its mean over the last period."""
        return self._advance / self._period

    @property
    def end_speed(self) -> float:
        """Path time per time, 0..1, at the end of the last period, so far as its change goes on."""
        return self._end / self._period

    @property
    def rate(self) -> float:
        """Change of the speed per time in the last period, 1/s."""
        return self._gain / self._period**2

    def reset(self, speed: float) -> None:
        """Set the speed at once; allowed only where the path stands."""
        self._advance = self._end = speed * self._period
        self._change = self._gain = 0.0

    def step(self, target: float, path_time: float, position: Callable[[float], Array]) -> float:
        """Move on for one period, with the speed on its way to `target`.

        Args:
            target: Wanted speed, 0..1.
            path_time: Path time now, s.
            position: Joint positions (n,) at a path time, standing before the start and after the end.

        Returns:
            Path time after the period, s.
        """
        wanted = target * self._period
        change = wanted - self._advance
        if change != 0.0:
            if not self.hurry:
                change = min(max(change, -self._ramp), self._ramp)
            change = self._allowed(change, path_time, position)
        # The mean of a period is the speed in its middle: of a change that begins, it has half.
        self._gain = change
        if change * self._change <= 0.0:
            change *= 0.5
        self._advance += change
        self._change = change
        rest = wanted - self._advance
        self._end = self._advance + min(max(0.5 * self._gain, min(rest, 0.0)), max(rest, 0.0))
        return path_time + self._advance

    def _allowed(self, change: float, path_time: float, position: Callable[[float], Array]) -> float:
        """The part of `change` that keeps the acceleration limits."""
        now = position(path_time)
        rest = position(path_time - self._advance) - 2.0 * now

        def keeps_limits(part: float) -> bool:
            second_difference = position(path_time + self._advance + part) + rest
            return bool((np.abs(second_difference) <= self._largest).all())

        if keeps_limits(change):
            return change
        good, bad = 0.0, change
        for _ in range(BISECTIONS):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if keeps_limits(middle) else (good, middle)
        return good
