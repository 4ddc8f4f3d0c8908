"""ProgramClock: a program's time in a node that follows the wall clock or `/clock`."""

import threading

from robots_controller.program.clock import LONGEST_WAIT, WallClock
from robots_core.ros.running.clocks import on_clock_set
from robots_core.ros.timed_node import TimedNode


class ProgramClock(WallClock):
    """See `Clock`. In simulated time a wait checks the clock whenever that is set.

    Args:
        node: Owner of the clock.
    """

    def __init__(self, node: TimedNode) -> None:
        self._node = node
        self._waits_in: threading.Condition | None = None
        if node.simulated_time:
            self._jumps = on_clock_set(node.get_clock(), self._wake)

    def now(self) -> float:
        """See `Clock`."""
        return self._node.now()

    def wait(self, condition: threading.Condition, deadline: float | None) -> None:
        """See `Clock`."""
        self._waits_in = condition
        if deadline is None:
            condition.wait()
        elif self._node.simulated_time:
            if self.now() < deadline:
                condition.wait()  # until something changes, or the clock is set
        else:
            condition.wait(min(max(deadline - self.now(), 0.0), LONGEST_WAIT))

    def _wake(self) -> None:
        condition = self._waits_in
        if condition is not None:
            with condition:
                condition.notify_all()
