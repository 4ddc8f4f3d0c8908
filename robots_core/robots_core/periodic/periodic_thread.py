"""A thread that calls a function on absolute deadlines."""

import math
import threading
import time
from collections.abc import Callable
from typing import Protocol

from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS
from robots_core.periodic.realtime import ask_for_realtime, idle_latency
from robots_core.validation import positive


class Rest(Protocol):
    """Which periods a thread may sleep through because its work has nothing to do; called from the thread."""

    def periods(self) -> int:
        """So many from the next one on have nothing to do if nothing comes."""

    def wait(self, timeout: float) -> bool:
        """Wait until something comes for the work, at most for `timeout`, s; whether it has come."""

    def left_out(self, periods: int) -> None:
        """So many were left out."""


class PeriodicThread:
    """Calls `work(deadline)` every `period` seconds, on deadlines that do not drift.

    Each deadline is the one before plus the period, so that a late call does not move the next ones.
    `deadline` is on the clock of `time.monotonic`.

    Args:
        work: What to do; an exception ends the thread and is handed to `on_error`.
        period: s, above 0.
        name: The thread's name.
        on_error: Called from the thread with the exception that ended it.
        realtime_priority: 1 to 99 asks the system for first-in-first-out scheduling with this priority, as
            ros2_control does; without the permission the thread runs as any other. 0 does not ask.
        idle_latency: Longest time that a processor may take to wake up, s, asked of the system while the
            thread runs (see `idle_latency`); None does not ask.
        rest: Periods that may be left out; none by default.
    """

    def __init__(
        self,
        work: Callable[[float], None],
        *,
        period: float,
        name: str,
        on_error: Callable[[BaseException], None],
        realtime_priority: int = 0,
        idle_latency: float | None = None,
        rest: Rest | None = None,
    ) -> None:
        self.period = positive(period, 'period', 's')
        self.missed = 0
        """Deadlines given up because the machine was too busy."""
        self.realtime = False
        """The system granted first-in-first-out scheduling."""
        self.idle_latency_kept = False
        """The system keeps to the idle latency that was asked for."""
        self._realtime_priority = realtime_priority
        self._idle_latency = idle_latency
        self._work, self._rest = work, rest
        self._on_error = on_error
        self._stopping = False
        self._thread = threading.Thread(target=self._loop, name=name, daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    @property
    def alive(self) -> bool:
        """The thread was started and its end was not requested."""
        return self._thread.is_alive() and not self._stopping

    def stop(self) -> None:
        """End the thread and wait for it; called by its own work, that call is the last."""
        self._stopping = True
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join()

    def _loop(self) -> None:
        if self._realtime_priority > 0:
            self.realtime = ask_for_realtime(self._realtime_priority)
        try:
            with idle_latency(self._idle_latency) as self.idle_latency_kept:
                self._keep_time()
        except BaseException as error:  # noqa: BLE001  # handed on, the thread's owner decides
            self._on_error(error)

    def _keep_time(self) -> None:
        period, work, rest, clock = self.period, self._work, self._rest, time.monotonic
        deadline = clock() + period
        while not self._stopping:
            now = clock()
            if now < deadline:
                time.sleep(deadline - now)
                now = clock()  # much later if the process was frozen meanwhile
            if now - deadline > MAX_LATE_PERIODS * period:
                self.missed += int((now - deadline) / period)
                deadline = now
            work(deadline)
            deadline += period
            if rest is not None and (most := rest.periods()) > 0:
                deadline += period * self._sleep_through(rest, most, deadline)

    def _sleep_through(self, rest: Rest, most: int, deadline: float) -> int:
        """How many periods from a deadline on were left out."""
        left_out = most
        if rest.wait(deadline + most * self.period - time.monotonic()):
            late = (time.monotonic() - deadline) / self.period
            left_out = min(max(math.ceil(late), 0), most)
        rest.left_out(left_out)
        return left_out
