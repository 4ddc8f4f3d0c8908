"""Outbox: the reports of the participants of one process, in their order."""

import threading
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol

from robots_core.ros.lockstep.protocol import LED, encode_reports


class Reporter(Protocol):
    """A participant, as far as its reports go."""

    @property
    def name(self) -> str:
        """Its node's name, with its namespace."""

    def report(self) -> list[int]:
        """What it has to report now."""


class Outbox:
    """Sends reports, or keeps them where the process has the lead.

    Args:
        publisher: Of the reports. One for all participants of a process: between messages of two publishers
            there is no order.
        wake: Wakes the executor of the process.
    """

    def __init__(self, publisher: Any, wake: Callable[[], None]) -> None:
        self._publisher, self._wake = publisher, wake
        self._lock = threading.Lock()
        self._keeper: int | None = None  # identity of the executor's thread
        self._kept: dict[Reporter, None] = {}

    def send(self, reporter: Reporter) -> None:
        """Send the report of a participant, or keep that it has one; from any thread."""
        with self._lock:
            keeper = self._keeper
            if keeper is None:
                self._publish((reporter,))
                return
            self._kept[reporter] = None
        if keeper != threading.get_ident():
            self._wake()

    def keep(self) -> None:
        """Keep reports until `give_back`; called in the executor's thread, as all that follows."""
        with self._lock:
            self._keeper = threading.get_ident()

    def take(self) -> Iterable[Reporter]:
        """Those that have had something to report since the last call."""
        with self._lock:
            kept, self._kept = self._kept, {}
        return kept

    def give_back(self, reporters: Iterable[Reporter], place: Sequence[int]) -> None:
        """Send reports from now on, and those of all, with the place of the run, at once."""
        with self._lock:
            self._keeper, self._kept = None, {}
            self._publish(reporters, (LED, *place))

    def sign_of_life(self) -> None:
        """Send a message without reports."""
        self._publisher.publish(encode_reports(()))

    def _publish(self, reporters: Iterable[Reporter], *before: Sequence[int]) -> None:
        self._publisher.publish(encode_reports([*before, *(one.report() for one in reporters)]))
