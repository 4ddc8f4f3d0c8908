"""CollisionEngine: the interface of collision libraries, for contact and distance of two solids."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from robots_core.blocks.collision.solids import Solid
from robots_core.validation import Array

Answer = tuple[float, Array, Array]
"""Distance (m, not above 0 in contact), nearest point on the first and on the other solid (3,), m."""


class CollisionEngine(ABC):
    """A set of solids as objects of a library.

    Args:
        solids: All solids; they are identified by their index.
    """

    def __init__(self, solids: Sequence[Solid]) -> None:
        self._placed = [-1] * len(solids)
        self._placement = 0
        self._R: Array
        self._t: Array

    def place(self, R: Array, t: Array) -> None:
        """Place all solids: orientations (s, 3, 3) and positions (s, 3), m."""
        # Solids are moved on demand: most pairs are excluded by the broad phase.
        self._R, self._t = R, t
        self._placement += 1

    def _is_stale(self, index: int) -> bool:
        """Whether a solid has to be moved now; from then on it counts as moved."""
        stale = self._placed[index] != self._placement
        self._placed[index] = self._placement
        return stale

    @abstractmethod
    def in_contact(self, first: int, second: int) -> bool:
        """Whether two solids touch or overlap."""

    @abstractmethod
    def distance(self, first: int, second: int) -> Answer:
        """Distance and nearest points, as computed by the library."""
