"""SampleTimes: when the samples of a sensor were valid, by stamps that may be of another clock."""

import math
from typing import Final

NANOSECONDS: Final = 1_000_000_000
FUTURE: Final = 0.05  # s; stamps from so near in the future come from clocks that differ a little


class SampleTimes:
    """The times of one sensor's samples, on the clock of the robot.

    A stamp that cannot be of that clock (a recording, another machine) still gives the time between samples;
    the soonest that one ever came is taken as its delay.

    Args:
        timeout: A sample older than this is stale, s.
    """

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout
        self._soonest = math.inf  # s, by stamps of another clock

    def valid_at(self, now: float, age: int) -> float:
        """When a sample was valid, s; now in s, and its age by the robot's clock in ns."""
        seconds = age / NANOSECONDS
        if -FUTURE <= seconds <= self._timeout:
            return (round(now * NANOSECONDS) - age) / NANOSECONDS  # in simulated time the stamp itself
        if not -self._timeout <= seconds - self._soonest <= self._timeout:
            self._soonest = seconds
        self._soonest = min(self._soonest, seconds)
        return now - (seconds - self._soonest)
