"""Outbox: the reports of the participants of one process, in their order and as few messages as possible."""

import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
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
    """Sends reports.

    Args:
        publisher: Of the reports. One for all participants of a process: between messages of two publishers
            there is no order.
        wake: Wakes the executor of the process.
    """

    def __init__(self, publisher: Any, wake: Callable[[], None]) -> None:
        self._publisher = publisher
        self._sending = threading.Lock()
        self._collecting: int | None = None  # identity of a thread
        self._kept = False
        self._wake = wake
        self._waiting: dict[Reporter, None] = {}

    def send(self, reporter: Reporter) -> None:
        """Send the report of a participant, now or at the end of what this thread does together."""
        collects = self._collecting == threading.get_ident()
        if collects or self._kept:
            with self._sending:
                self._waiting[reporter] = None
            if not collects:
                self._wake()
        else:
            self._send((reporter,))

    @contextmanager
    def together(self) -> Iterator[None]:
        """Send what is to be reported in this thread meanwhile at the end, as one message."""
        self._collecting = threading.get_ident()
        try:
            yield
        finally:
            self._collecting = None
            if not self._kept:
                self._send(self.take())

    def keep(self) -> None:
        """Send nothing until `give_back`: `take` returns what would be sent."""
        self._kept = True

    def take(self) -> Iterable[Reporter]:
        """Those that have something to report."""
        with self._sending:
            waiting, self._waiting = self._waiting, {}
        return waiting

    def send_now(self) -> None:
        """Send a message without reports, as a sign of life."""
        self._publisher.publish(encode_reports(()))

    def give_back(self, reporters: Iterable[Reporter], place: Sequence[int]) -> None:
        """End `keep`, and send what is to be reported by all, with the place of the run."""
        self._kept = False
        self.take()
        self._send(reporters, ((LED, *place),))

    def _send(self, reporters: Iterable[Reporter], before: Iterable[Sequence[int]] = ()) -> None:
        with self._sending:
            if reports := [*before, *(reporter.report() for reporter in reporters)]:
                self._publisher.publish(encode_reports(reports))
