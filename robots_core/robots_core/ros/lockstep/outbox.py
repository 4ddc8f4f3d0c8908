"""Outbox: the reports of the participants of one process, in their order."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from robots_core.ros.lockstep.protocol import LED, encode_reports

if TYPE_CHECKING:
    from robots_core.ros.lockstep.participant import Participant


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
        self._kept: dict[Participant, None] = {}

    def send(self, participant: Participant) -> None:
        """Send the report of a participant, or keep that it has one; from any thread."""
        with self._lock:
            keeper = self._keeper
            if keeper is None:
                self._publish((participant,))
                return
            self._kept[participant] = None
        if keeper != threading.get_ident():
            self._wake()

    def keep(self) -> None:
        """Keep reports until `give_back`; called in the executor's thread, as all that follows."""
        with self._lock:
            self._keeper = threading.get_ident()

    def take(self) -> Iterable[Participant]:
        """Those that have had something to report since the last call."""
        with self._lock:
            kept, self._kept = self._kept, {}
        return kept

    def give_back(self, participants: Iterable[Participant], place: Sequence[int]) -> None:
        """Send reports from now on, and those of all, with the place of the run, at once."""
        with self._lock:
            self._keeper, self._kept = None, {}
            self._publish(participants, (LED, *place))

    def sign_of_life(self) -> None:
        """Send a message without reports."""
        self._publisher.publish(encode_reports(()))

    def _publish(self, participants: Iterable[Participant], *before: Sequence[int]) -> None:
        self._publisher.publish(encode_reports([*before, *(one.report() for one in participants)]))
