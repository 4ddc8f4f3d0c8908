"""RestingRate: a loop reports seldom what has not changed for a while."""

from typing import Final

RESTING_RATE: Final = 25.0
"""Default, Hz: so often nodes show that they live too."""
LOWEST: Final = 20.0  # Hz: some messages come within the shortest watchdog
RESTED: Final = 0.5
"""As long is what rests still reported in each cycle, s.

At the end of a motion, while drives settle, the controller checks the feedback of each period.
"""


class RestingRate:
    """Says in which cycles of a loop something that may rest is reported.

    In all cycles while it moves and as long as it has not rested for `after`; then in one of `every`.

    Args:
        every: Cycles from one report to the next at rest, at least 1.
        after: Cycles of rest that are still reported one by one.
    """

    def __init__(self, every: int, after: int) -> None:
        self._every, self._after = every, after
        self._rested = self._reported = 0  # cycles since it began to rest

    def due(self, *, resting: bool, early: bool = False) -> bool:
        """A report is due in this cycle; to be called once in each.

        Args:
            resting: It rests.
            early: If half of the time has passed, the report is due now.
        """
        self._rested = self._rested + 1 if resting else 0
        waited = self._rested - self._reported
        due = self._rested <= self._after or waited >= self._every or (early and 2 * waited >= self._every)
        if due:
            self._reported = self._rested
        return due

    @property
    def ahead(self) -> int:
        """So many cycles from the next one on, if it rests in all of them, no report is due."""
        if self._rested < self._after:
            return 0
        return max(0, self._reported + self._every - self._rested - 1)

    def pass_over(self, cycles: int) -> None:
        """So many cycles at rest were left out, without reports."""
        self._rested += cycles

    def restart(self) -> None:
        """Report one by one again, as if it had moved."""
        self._rested = self._reported = 0
