"""LockstepTimes: the simulated time at which each message of a lock-step run was sent."""

from bisect import bisect_right
from collections.abc import Iterable, Mapping
from typing import Final, Protocol

from rosbags.interfaces import Connection
from rosgraph_msgs.msg import Clock

from robots_core.ros.lockstep.phases import START
from robots_core.ros.messages import nanoseconds

QUEUE_DEPTH: Final = 5000

Sent = tuple[int, Connection, bytes]
"""Time of the system's clock or simulated time, ns; connection; serialized message."""


class Clocks(Protocol):
    """A subscription to `/clock`."""

    def take_all(self) -> Iterable[tuple[Clock, Mapping[str, int]]]:
        """What came since the last call, with its `source_timestamp`, ns."""


class LockstepTimes:
    """Takes each message for sent at the last instant whose `/clock` was sent before it.

    Messages of one instant follow each other by a nanosecond, in the order in which they were sent. Topics
    are read one after the other: a message may be seen after others that were sent later. So all wait
    until the topics are read again.

    Args:
        clock: Takes `/clock`, with the middleware's information on each message.
    """

    def __init__(self, clock: Clocks) -> None:
        self._clock = clock
        self._sent: list[int] = []  # when the clock of an instant was sent, ns of the system's clock
        self._instants: list[int] = []
        self._waiting: list[Sent] = []
        self._last = START - 1

    def stamped(self, came: Iterable[Sent], *, last: bool) -> Iterable[Sent]:
        """The messages whose instants are known, in order, with simulated times.

        Args:
            came: What came since the last call, with the times of the system's clock.
            last: Nothing follows.
        """
        messages = sorted([*self._waiting, *came], key=lambda message: message[0])
        # Sent before it, a message was there when this check of the topics began.
        complete = self._sent[-1] if self._sent else 0
        for clock, info in self._clock.take_all():
            self._sent.append(info['source_timestamp'])
            self._instants.append(nanoseconds(clock.clock))
        known = len(messages)
        if not last:
            known = bisect_right(messages, complete, key=lambda message: message[0])
        self._waiting = messages[known:]
        for sent, connection, data in messages[:known]:
            place = bisect_right(self._sent, sent)
            instant = self._instants[place - 1] if place else START
            self._last = max(instant, self._last + 1)
            yield self._last, connection, data
        if len(self._sent) > QUEUE_DEPTH:
            del self._sent[:-QUEUE_DEPTH], self._instants[:-QUEUE_DEPTH]
