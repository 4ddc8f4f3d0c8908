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
        self._rested = 0

    def due(self, *, resting: bool) -> bool:
        """A report is due in this cycle; to be called once in each."""
        self._rested = self._rested + 1 if resting else 0
        return self._rested <= self._after or (self._rested - self._after) % self._every == 0

    def restart(self) -> None:
        """Report one by one again, as if it had moved."""
        self._rested = 0
