"""ExecutorWatch: notices that an executor calls no callbacks any more."""

import math
import threading
from collections.abc import Callable
from typing import Final

from rclpy.executors import Executor

from robots_core.periodic.realtime import processor_share
from robots_core.periodic.watchdog import CHECKS, Watchdog

HUNG: Final = 10.0
"""A callback that takes longer, s, waits for something that does not come."""


class ExecutorWatch:
    """Notices a callback that does not return, by a task that the executor is given now and then.

    Args:
        executor: The executor; it spins.
        on_hung: Called once when it calls nothing any more.
        timeout: A task that is not done by then never will be, s.
        share: See `Watchdog`.
    """

    def __init__(
        self,
        executor: Executor,
        on_hung: Callable[[], None],
        *,
        timeout: float = HUNG,
        share: Callable[[], float] = processor_share,
    ) -> None:
        self._executor, self._on_hung = executor, on_hung
        self._period = 0.5 * timeout / CHECKS
        self._watchdog = Watchdog(timeout, share)
        self._looking = threading.Lock()
        self._looked = -math.inf
        self._done = True

    def check(self, now: float) -> bool:
        """Whether callbacks return; from any thread, often within the timeout."""
        with self._looking:
            if now - self._looked >= self._period:
                self._looked = now
                if self._watchdog.check(now, alive=self._done):
                    self._on_hung()
                if self._done:
                    self._done = False
                    self._executor.create_task(self._finish)
            return not self._watchdog.lost

    def _finish(self) -> None:
        self._done = True
