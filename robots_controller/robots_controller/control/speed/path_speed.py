"""PathSpeed: how fast the path time runs, for override, pause and stop on the path."""

import numpy as np

from robots_controller.control.followed_motion import FollowedMotion
from robots_core.validation import Array

# Halvings of a change of speed that the limits do not allow; 2^-10 of it is below what matters.
BISECTIONS = 10
# Second differences of float64 positions over one period are exact to about 1e-9 of a limit.
ROUNDING = 1e-8
# Of the planned speed; slower, and late on a long path, the path time of a period may be lost in rounding.
SLOWEST = 1e-4


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
        self._period = period
        self._largest = acceleration * period**2 * (1.0 + ROUNDING)
        self._ramp = period**2 / ramp_time
        self._advance = self._end = period
        self._gain = 0.0
        self.fast_stop = False
        """Change the speed as fast as the limits permit, whatever the ramp time."""

    @property
    def speed(self) -> float:
        """Path time per time, 0..1; its mean over the last period."""
        return self._advance / self._period

    @property
    def end_speed(self) -> float:
        """Path time per time, 0..1, at the end of the last period, so far as its change continues."""
        return self._end / self._period

    @property
    def rate(self) -> float:
        """Change of the speed per time in the last period, 1/s."""
        return self._gain / self._period**2

    def reset(self, speed: float) -> None:
        """Set the speed at once; allowed only where the path stands."""
        self._advance = self._end = speed * self._period
        self._gain = 0.0

    def even(self, target: float) -> bool:
        """The speed is `target` and stays so, and the path time passes."""
        return target * self._period == self._end == self._advance >= SLOWEST * self._period

    def ahead(self, path_time: float, periods: int) -> Array:
        """Path times after each of the next periods at an even speed, (periods,) s, as `step` gives them."""
        times = np.full(periods + 1, self._advance)
        times[0] = path_time
        return np.asarray(np.add.accumulate(times)[1:])

    def keep(self) -> None:
        """Periods at an even speed have passed."""
        self._gain = 0.0

    def step(self, target: float, path_time: float, path: FollowedMotion) -> float:
        """Move on for one period, with the speed on its way to `target`.

        Args:
            target: Wanted speed, 0..1.
            path_time: Path time now, s.
            path: The path.

        Returns:
            Path time after the period, s.
        """
        wanted = target * self._period
        gain = wanted - self._end
        if not self.fast_stop:
            gain = min(max(gain, -self._ramp), self._ramp)
        if gain != 0.0:
            gain = self._bounded(gain, path.sample(path_time))
            gain = self._bounded(gain, path.sample(path_time + self._end + 0.5 * gain))
        # The mean of a period is the speed in its middle, where that changes evenly.
        change = self._end + 0.5 * gain - self._advance
        allowed = self._allowed(change, path_time, path) if change != 0.0 else 0.0
        if allowed == change:
            end = self._end + gain
            self._advance = 0.5 * (self._end + end)
        else:
            gain = allowed
            self._advance += allowed
            rest = wanted - self._advance
            end = self._advance + min(max(0.5 * gain, min(rest, 0.0)), max(rest, 0.0))
        self._gain, self._end = gain, end
        return path_time + self._advance

    def _bounded(self, gain: float, sample: Array) -> float:
        """The part of `gain` with which the acceleration at a point of the path keeps its limits."""
        _, q_s, q_ss = sample
        by_gain = q_s * gain
        own = np.sign(by_gain) * q_ss * self._end**2
        room = np.maximum(self._largest - own, 0.0)
        wanted = np.abs(by_gain)
        beyond = wanted > room
        return gain * float((room[beyond] / wanted[beyond]).min(initial=1.0))

    def _allowed(self, change: float, path_time: float, path: FollowedMotion) -> float:
        """The part of `change` that keeps the acceleration limits."""
        rest = path.position(path_time - self._advance) - 2.0 * path.position(path_time)

        def keeps_limits(part: float) -> bool:
            second_difference = path.position(path_time + self._advance + part) + rest
            return bool((np.abs(second_difference) <= self._largest).all())

        if keeps_limits(change):
            return change
        good, bad = 0.0, change
        for _ in range(BISECTIONS):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if keeps_limits(middle) else (good, middle)
        return good
