"""AccelerationEstimate: from measured velocities, by difference quotients and a low-pass filter."""

from typing import Final

import numpy as np

from robots_core.validation import Array

LONGEST_GAP: Final = 0.1  # s, between samples of which an acceleration is estimated


class AccelerationEstimate:
    """The accelerations of one robot's axes.

    The filter is q_ddot' = (dq_dot/dt - q_ddot) / filter_time, by the implicit Euler method.

    Args:
        filter_time: Its time constant, s; 0 gives the difference quotients.
    """

    def __init__(self, filter_time: float) -> None:
        self.filter_time = filter_time
        self._last: tuple[float, Array] | None = None
        self._q_ddot: Array = np.zeros(0)

    def take(self, time: float, q_dot: Array) -> Array:
        """The accelerations, (n,), rad/s^2 (m/s^2), with velocities, rad/s (m/s), measured at a time, s.

        Zero after the first sample, after a gap longer than `LONGEST_GAP`, and where time goes back.
        """
        last, self._last = self._last, (time, q_dot)
        gap = 0.0 if last is None else time - last[0]
        if last is None or not 0.0 < gap <= LONGEST_GAP:
            self._q_ddot = np.zeros_like(q_dot)
        else:
            share = gap / (gap + self.filter_time)
            self._q_ddot = self._q_ddot + share * ((q_dot - last[1]) / gap - self._q_ddot)
        return self._q_ddot
