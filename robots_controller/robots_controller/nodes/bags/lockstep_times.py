"""LockstepTimes: the simulated time at which each message of a lock-step run was sent."""

from bisect import bisect_right, insort
from collections import Counter
from collections.abc import Iterable
from typing import Final

from rosbags.interfaces import Connection

from robots_core.ros.lockstep.phases import START
from robots_core.ros.messages import nanoseconds
from robots_core.ros.streams.polled_subscription import PolledSubscription

QUEUE_DEPTH: Final = 5000

Sent = tuple[int, Connection, bytes]
"""Time of the system's clock or simulated time, ns; connection; serialized message."""


class LockstepTimes:
    """Takes each message for sent at the last instant whose `/clock` was sent before it.

    The clock has several senders, between whose messages there is no order: see `expect`.

    Messages of one instant follow each other by a nanosecond, in the order in which they were sent. Topics
    are read one after the other: a message may be seen after others that were sent later. So all wait
    until the topics are read again. One that comes later still, as it was sent again, is the last one of its
    instant.
    """

    def __init__(self, clock: PolledSubscription) -> None:
        self._clock = clock
        self._sent: list[int] = []  # when the clock of an instant was sent, ns of the system's clock
        self._instants: list[int] = []
        self._forgotten = 0  # instants
        self._complete = 0  # ns of the system's clock: those of all instants that were sent before are here
        self._expected = 0, START
        self._waiting: list[Sent] = []
        self._counts = Counter[int]()  # messages of the instants

    def expect(self, count: int, last: int) -> None:
        """Wait for the clocks of so many instants up to `last` (ns) before a later one is relied on.

        Called before whoever sends the clock next does so.
        """
        self._expected = count, last

    @property
    def count(self) -> int:
        """Number of instants whose clocks have come."""
        return self._forgotten + len(self._instants)

    @property
    def missing(self) -> int:
        """Number of expected clocks that have not come."""
        count, last = self._expected
        return max(count - self._forgotten - bisect_right(self._instants, last), 0)

    def stamped(self, came: Iterable[Sent], *, last: bool) -> Iterable[Sent]:
        """The messages whose instants are known, in order, with simulated times.

        Args:
            came: What came since the last call, with the times of the system's clock.
            last: Nothing follows.
        """
        messages = sorted([*self._waiting, *came], key=lambda message: message[0])
        # Sent before it, a message was there when this check of the topics began.
        complete = self._complete
        for clock, info in self._clock.take_all():
            insort(self._sent, info['source_timestamp'])
            insort(self._instants, nanoseconds(clock.clock))
        if self._sent and not self.missing:
            self._complete = self._sent[-1]
        known = len(messages)
        if not last:
            known = bisect_right(messages, complete, key=lambda message: message[0])
        self._waiting = messages[known:]
        for sent, connection, data in messages[:known]:
            place = bisect_right(self._sent, sent)
            instant = self._instants[place - 1] if place else START
            yield instant + self._counts[instant], connection, data
            self._counts[instant] += 1
        if len(self._sent) > QUEUE_DEPTH:
            for instant in self._instants[:-QUEUE_DEPTH]:
                del self._counts[instant]
            self._forgotten += len(self._sent) - QUEUE_DEPTH
            del self._sent[:-QUEUE_DEPTH], self._instants[:-QUEUE_DEPTH]
