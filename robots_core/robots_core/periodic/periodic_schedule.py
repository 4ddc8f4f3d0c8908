"""PeriodicSchedule: which multiples of a period are due, on a clock that is handed in."""

import math
from typing import Final

# Past this many missed periods a loop starts a new schedule instead of catching up in a burst.
MAX_LATE_PERIODS: Final = 5


class PeriodicSchedule:
    """The multiples of a period from the first time on that the clock shows.

    Args:
        period: ns, above 0.
        origin: Time of which the others are whole periods away, ns.
        most_late: It starts anew when more periods than these were missed. Infinite (the default) for a clock
            that advances in steps, as that of a simulation.
    """

    def __init__(self, period: int, *, origin: int = 0, most_late: float = math.inf) -> None:
        self.missed = 0
        """Times given up because the clock jumped over them."""
        self.next_time: int | None = None
        """When the next one is due, ns; None before the clock was read."""
        self._period, self._origin, self._most_late = period, origin, most_late

    def begin(self, now: int) -> None:
        """Start a new schedule, whose first time is `now` (ns) or the next multiple after it."""
        self.next_time = self.first(now)

    def first(self, time: int) -> int:
        """The first multiple that is not before a time, ns."""
        return self._origin - (self._origin - time) // self._period * self._period

    def due(self, now: int) -> list[int]:
        """The times that are due, ns, in order; each is returned once.

        A clock that was set back, or that jumped over more than `most_late` periods, starts a new schedule.

        Args:
            now: ns.
        """
        period = self._period
        if self.next_time is None or self.next_time - now > period:
            self.begin(now)
        assert self.next_time is not None
        late = (now - self.next_time) // period
        if late > self._most_late:
            self.missed += late
            self.next_time += late * period
        times = list(range(self.next_time, now + 1, period))
        self.next_time += len(times) * period
        return times
