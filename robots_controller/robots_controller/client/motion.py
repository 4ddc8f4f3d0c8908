"""Motion: one motion that a client has commanded."""

import threading
from collections.abc import Callable, Iterator
from typing import Final

from robots_core.errors import RobotsError

UPDATE_PERIOD: Final = 0.1  # s


class Motion:
    """A motion on its way.

    Args:
        number: Grows from motion to motion.
        flush: Called before waiting: no motion follows that it could blend into.
        raised: Called with the number before an error is raised.
    """

    def __init__(self, number: int, flush: Callable[[], None], raised: Callable[[int], None]) -> None:
        self.number = number
        self._flush, self._raised = flush, raised
        self._ended = threading.Event()
        self._error: RobotsError | None = None
        self._progress = 0.0

    @property
    def done(self) -> bool:
        """It has ended, at its target or not."""
        return self._ended.is_set()

    @property
    def progress(self) -> float:
        """Fraction that is done, 0..1; of motions that blend, the fraction of all of them."""
        return self._progress

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until the robot is at the target.

        Args:
            timeout: Longest wait, s; without end by default.

        Returns:
            False if the motion is still under way.

        Raises:
            RobotsError: why the robot is not at the target.
        """
        self._flush()
        ended = self._ended.wait(timeout)
        if self._error is not None:
            self._raised(self.number)
            raise self._error
        return ended

    def updates(self, period: float = UPDATE_PERIOD) -> Iterator[float]:
        """The progress, once in each period (s), until the motion has ended.

        Raises:
            RobotsError: why the robot is not at the target.
        """
        while not self.wait(period):
            yield self._progress
        yield self._progress

    def advance(self, progress: float) -> None:
        """The controller reports progress."""
        self._progress = progress

    def end(self, error: RobotsError | None) -> None:
        """The motion has ended: None, or why the robot is not at the target."""
        self._error = error
        if error is None:
            self._progress = 1.0
        self._ended.set()
