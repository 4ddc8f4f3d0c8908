"""RestartPolicy: when a node that has died is started again; the time is handed in."""

from dataclasses import dataclass
from typing import Final

FIRST_DELAY: Final = 0.5  # s
LONGEST_DELAY: Final = 30.0  # s
MOST_DEATHS: Final = 6
"""In a row: one more restart would not help either."""
STEADY: Final = 60.0
"""A node that has lived for so long starts a new row, s."""


@dataclass
class _Deaths:
    row: int = 0
    started: float = 0.0


class RestartPolicy:
    """Each death in a row doubles the delay of the next start, until there are too many."""

    def __init__(self) -> None:
        self._deaths: dict[str, _Deaths] = {}
        self._due: dict[str, float] = {}

    def died(self, node: str, now: float) -> float | None:
        """A node has died: the delay until it is started again, s; None to give it up."""
        deaths = self._deaths.setdefault(node, _Deaths())
        deaths.row = 1 if now - deaths.started >= STEADY else deaths.row + 1
        if deaths.row >= MOST_DEATHS:
            return None
        delay = min(FIRST_DELAY * 2.0 ** (deaths.row - 1), LONGEST_DELAY)
        self._due[node] = now + delay
        return delay

    def due(self, now: float) -> list[str]:
        """The nodes to start now, once each."""
        found = [node for node, time in self._due.items() if time <= now]
        for node in found:
            del self._due[node]
            self._deaths[node].started = now
        return found
