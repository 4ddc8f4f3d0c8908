"""Watchdog: something that gives signs of life is lost when they stop coming."""

import math
from collections.abc import Callable
from typing import Final

from robots_core.errors import InvalidInputError

WATCHDOG: Final = 0.2
"""Default, s: how long a process of a quiet machine may give no sign of life."""
SHORTEST: Final = 0.1  # s: some signs of life fit in
LONGEST: Final = 60.0  # s
CHECKS: Final = 5
"""Looks within the timeout."""


class Watchdog:
    """Judges by the watcher's own time, as far as it was spent with looking.

    What was never seen is not lost. A watcher that the machine has held up counts one regular step for that:
    what it watches may have been held up too. Where processes have to share processors, silence counts by the
    share that each of them gets, the larger one of two checks: threads that run for a moment are no load.

    Args:
        timeout: Without a sign of life for this long it is lost, s; see `checked_watchdog`.
        share: The share of a processor that a process gets now, above 0 to 1, see `processor_share`.
    """

    def __init__(self, timeout: float, share: Callable[[], float] = lambda: 1.0) -> None:
        self._timeout, self._share = timeout, share
        self._silence: float | None = None
        self._before = 0.0
        self._last_share = 0.0

    @property
    def seen(self) -> bool:
        """A sign of life has come."""
        return self._silence is not None

    @property
    def lost(self) -> bool:
        """It was seen, and then was silent for the timeout."""
        return self._silence is not None and self._silence > self._timeout

    @property
    def remaining(self) -> float:
        """How much longer it may be silent, s; infinite if it was not seen or is lost."""
        return math.inf if self._silence is None or self.lost else self._timeout - self._silence

    def expect(self) -> None:
        """What was never seen is there: its silence counts from now on."""
        if self._silence is None:
            self._silence = 0.0

    def check(self, now: float, *, alive: bool, age: float | None = None) -> bool:
        """Look, at least `CHECKS` times within the timeout.

        Args:
            now: Time, s.
            alive: A sign of life has come since the last check.
            age: How long ago the newest came, s; None where that is unknown: halfway between the two checks.

        Returns:
            It was lost just now.
        """
        step, self._before = min(now - self._before, self._timeout / CHECKS), now
        lost = self.lost
        if alive:
            self._silence = 0.5 * step if age is None else min(max(age, 0.0), step)
            self._last_share = 0.0
        elif self._silence is not None:
            # Reading the share takes longer than a check: not between two signs of life on a quiet machine.
            usual = self._silence < 2.0 * self._timeout / CHECKS
            self._silence += step if usual else step * self._larger_share()
        return self.lost and not lost

    def _larger_share(self) -> float:
        before, self._last_share = self._last_share, self._share()
        return max(before, self._last_share)


def checked_watchdog(value: float) -> float:
    """A timeout of a watchdog, s, or 0 for none.

    Raises:
        InvalidInputError: another one.
    """
    if value != 0.0 and not SHORTEST <= value <= LONGEST:
        raise InvalidInputError(
            f'watchdog = {value!r} s must be in [{SHORTEST:g}, {LONGEST:g}] s, or 0 for none'
        )
    return value
