"""ReferenceCheck: whether references, at the times of their stamps, keep the limits of the axes."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

# Of a limit: rounding of second differences, as in the controller's limit guard.
TOLERANCE: Final = 1e-6
# A stamp in s since 1970 has a resolution of 2.4e-7 s; the time between two stamps is off by at most this.
STAMP_ERROR: Final = 1e-6  # s
# A sender that was held up for longer continues where it was, at a later time (`PeriodicSchedule`): its
# stamps then say nothing about its speed.
JUDGED_PERIODS: Final = MAX_LATE_PERIODS + 0.5
# Without stamps: the last reference may be of the period before, and this one of the period after.
SLACK_PERIODS: Final = 2.0


class ReferenceCheck:
    """Judges each reference by those that were taken before it.

    References that change their velocity by at most a T in each period T have mean velocities w over the
    times t1 and t2 between three of them that differ by at most a (t1 + t2) / 2, whichever of the references
    between these three were lost or refused. This holds at the stamps, whenever the references arrive.

    Args:
        axes: The robot's limits.
        period: Time of one step of the drives, s.
        timeout: The axes may have moved at most for so long without references, s.
    """

    def __init__(self, axes: AxesData, *, period: float, timeout: float) -> None:
        self._axes, self._period, self._timeout = axes, period, timeout
        self._step = SLACK_PERIODS * period * axes.velocity
        self._fastest = axes.velocity * (1.0 + TOLERANCE)
        self._hardest = axes.acceleration * (1.0 + TOLERANCE)
        self._still: Array = np.zeros(axes.num_axes)
        self.last = self._still
        """The last reference that was taken, (n,), rad (m)."""
        self._stamp = self._time = -np.inf
        self._newest = -np.inf  # stamp of the last reference, taken or refused
        self._timed = False  # the sender was not held up since the last reference that was taken
        self._mean: Array | None = None  # velocity up to the last reference; None if it is not known
        self._span = period  # s, that this is the mean of

    def begin(self, now: float, q: Array, mean: Array, stamp: float) -> None:
        """Take a reference without regard to those before it; as for `problem`.

        Args:
            now: Time, s.
            q: Reference positions, (n,), rad (m).
            mean: Mean velocity in the period before, (n,), rad/s (m/s).
            stamp: When the reference was due, s.
        """
        self._take(now, q, stamp)
        self._mean, self._span = mean, self._period

    def forget(self) -> None:
        """The next reference may have any velocity within the limits."""
        self._mean = None

    def take(self, now: float, q: Array, stamp: float) -> None:
        """Take the reference that came last; as for `problem`."""
        self._span = stamp - self._stamp
        if not self._timed:
            self._mean = None
        elif q is self.last:  # one that stands
            self._mean = self._still
        else:
            self._mean = (q - self.last) / self._span
        self._take(now, q, stamp)

    def problem(self, now: float, q: Array, q_dot: Array, stamp: float, sender_period: float = 0.0) -> str:
        """Why the axes could not follow, for a person; '' if they can.

        Args:
            now: Time, s.
            q: Reference positions, (n,), rad (m).
            q_dot: Reference velocities, (n,), rad/s (m/s).
            stamp: When the reference was due, s on its sender's clock; -inf if that is not known.
            sender_period: Time between two references of the sender, s; 0 if that is not known.
        """
        self.receive(stamp, sender_period)
        fast = np.abs(q_dot) > self._fastest
        if fast.any():
            return self._too_fast(q_dot, fast)
        span, elapsed = stamp - self._stamp, now - self._time
        if self._timed:
            return self._beyond_limits(q, span)
        return self._too_far(q, max(elapsed, span))  # in this order: between unknown stamps the span is NaN

    def receive(self, stamp: float, sender_period: float = 0.0) -> None:
        """A reference has come; as for `problem`, which does this too."""
        gap = stamp - self._newest
        self._timed &= bool(0.0 < gap <= JUDGED_PERIODS * (sender_period or self._period))
        self._newest = stamp

    def _take(self, now: float, q: Array, stamp: float) -> None:
        self.last, self._time, self._stamp = q, now, stamp
        self._newest, self._timed = stamp, math.isfinite(stamp)

    def _too_fast(self, velocity: Array, fast: NDArray[np.bool_]) -> str:
        worst = int(fast.argmax())
        value, limit = (self._value(values, worst, 'velocity') for values in (velocity, self._axes.velocity))
        return f'{self._axes.names[worst]} would move at {value}, its limit is {limit}'

    def _beyond_limits(self, q: Array, span: float) -> str:
        """By the stamps, `span` s apart."""
        mean = (q - self.last) / span
        error = STAMP_ERROR * np.abs(mean) / span
        fast = np.abs(mean) - error > self._fastest
        if fast.any():
            return self._too_fast(mean, fast)
        if self._mean is None:
            return ''
        between = 0.5 * (self._span + span)
        rate = (mean - self._mean) / between
        allowed = self._hardest + (error + STAMP_ERROR * np.abs(self._mean) / self._span) / between
        hard = np.abs(rate) > allowed
        if hard.any():
            worst = int(hard.argmax())
            value, limit = (self._value(values, worst, 'acceleration') for values in (rate, allowed))
            return f'{self._axes.names[worst]} would accelerate at {value}, its limits allow {limit}'
        return ''

    def _too_far(self, q: Array, elapsed: float) -> str:
        """By the way alone, `elapsed` s after the last one."""
        change = np.abs(q - self.last)
        if (change <= self._step).all():
            return ''
        allowed = self._step + min(elapsed, self._timeout) * self._axes.velocity
        worst = int((change - allowed).argmax())
        if change[worst] <= allowed[worst]:
            return ''  # the machine has held up its sender, or these drives
        limit = self._value(allowed, worst, 'position')
        name, value = self._axes.names[worst], self._value(change, worst, 'position')
        return f'{name} would step by {value}, its limits allow {limit}'

    def _value(self, values: Array, index: int, quantity: str) -> str:
        return f'{values[index]:.4g} {self._axes.unit(index, quantity)}'
