"""Outbox: the reports of the participants of one process, in their order and as few messages as possible."""

import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from robots_core.ros.lockstep.protocol import encode_reports


class Reporter(Protocol):
    """A participant, as far as its reports go."""

    def report(self) -> list[int]:
        """What it has to report now."""


class Outbox:
    """Sends reports.

    Args:
        publisher: Of the reports. One for all participants of a process: between messages of two publishers
            there is no order.
    """

    def __init__(self, publisher: Any) -> None:
        self._publisher = publisher
        self._sending = threading.Lock()
        self._collecting: int | None = None  # identity of a thread
        self._waiting: dict[Reporter, None] = {}

    def send(self, reporter: Reporter) -> None:
        """Send the report of a participant, now or at the end of what this thread does together."""
        if self._collecting == threading.get_ident():
            self._waiting[reporter] = None
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
            if self._waiting:
                waiting, self._waiting = self._waiting, {}
                self._send(waiting)

    def _send(self, reporters: Iterable[Reporter]) -> None:
        with self._sending:
            self._publisher.publish(encode_reports(reporter.report() for reporter in reporters))
