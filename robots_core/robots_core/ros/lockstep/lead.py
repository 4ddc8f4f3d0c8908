"""Lead: participants that share a process go from turn to turn by themselves, without a message for each."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Final

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rosgraph_msgs.msg import Clock as ClockMessage

from robots_core.ros.lockstep.agenda import LockstepError, Reports, Turn
from robots_core.ros.lockstep.counted_endpoints import ALL
from robots_core.ros.lockstep.phases import START
from robots_core.ros.lockstep.protocol import LED, encode_clock, encode_reports

if TYPE_CHECKING:
    from robots_core.ros.lockstep.participant import Participant

SLICE: Final = 0.05  # s of the wall clock


class Lead:
    """The coordinator's part among participants that are all there are in a run.

    A turn that the coordinator gives takes two messages between processes, and several of them an instant;
    here it takes none. The coordinator gives the lead away for a slice of time. It has it again earlier when
    nothing is due, and when the run cannot continue: then it finds out itself why, and says so.

    All methods but `send` are called in the executor's thread.

    Args:
        participants: Of this process, at least one, before they are spun. All report by the publisher of the
            first one: between messages of two publishers there is no order.
    """

    def __init__(self, participants: Sequence[Participant]) -> None:
        self._participants = {one.name: one for one in participants}
        for participant in participants:
            participant.lead = self
        self._reports, self._wake = participants[0].reports, participants[0].wake
        self._lock = threading.Lock()
        self._keeper: int | None = None  # identity of the executor's thread, while it keeps reports
        self._kept: dict[Participant, None] = {}
        self.name: Final = participants[0].name
        """The participant that receives the coordinator's messages about the lead."""
        node = participants[0].node
        self._clock: Any = Node.create_publisher(node, ClockMessage, '/clock', ALL)
        self._node = node
        self._reported = Reports()
        self._traffic, self._agenda = self._reported.traffic, self._reported.agenda
        self.active = False
        """The participants have the lead."""
        self.sequence = self._instants = 0
        self.time = self._published = START
        """The present instant, ns."""
        self.sent: tuple[int, ...] = ()
        """Messages sent so far on each polled topic."""
        self._end = 0.0  # of the slice, s of the wall clock
        self._timer = Node.create_timer(
            node, SLICE, self._give_back, clock=Clock(clock_type=ClockType.STEADY_TIME), autostart=False
        )

    @property
    def is_matched(self) -> bool:
        """All subscriptions to the clock have found this publisher of it."""
        others = self._node.get_subscriptions_info_by_topic('/clock')
        return bool(self._clock.get_subscription_count() >= len(others))

    def send(self, participant: Participant) -> None:
        """Send the report of a participant, or with the lead keep that it has one; from any thread."""
        with self._lock:
            keeper = self._keeper
            if keeper is None:
                self._publish((participant,))
                return
            self._kept[participant] = None
        if keeper != threading.get_ident():
            self._wake()

    def _publish(self, participants: Iterable[Participant], *before: Sequence[int]) -> None:
        self._reports.publish(encode_reports([*before, *(one.report() for one in participants)]))

    def begin(self, sequence: int, now: int, phase: int) -> None:
        """Take the lead, at an instant (ns) and the next phase of it."""
        self.active, self.sequence = True, sequence
        self.time = self._published = now
        self._instants = 0
        self._agenda.resume(now, phase)
        with self._lock:
            self._keeper = threading.get_ident()
        for participant in self._participants.values():
            participant.answer(sequence)
            self.send(participant)
        self._end = time.monotonic() + SLICE
        self._timer.reset()

    def go_on(self) -> None:
        """Do what is due, until something has to come first or the slice is over."""
        while self.active:
            with self._lock:
                kept, self._kept = self._kept, {}
            for participant in kept:
                _, _, *numbers = participant.report()
                self._traffic.join(participant.name, participant.counts.endpoints)
                self._reported.read(participant.name, *numbers)
            if not self._reported.quiet:
                return
            try:
                turn = self._agenda.next_turn() if time.monotonic() < self._end else None
            except LockstepError:
                self._give_back(failed=True)
                return
            if turn is None:
                self._give_back()
            else:
                self._take(turn)

    def _take(self, turn: Turn) -> None:
        self.time = turn.time
        self.sent = tuple(self._traffic.sent(topic) for topic in self._participants[self.name].polled)
        if turn.time != self._published:
            self._published = turn.time
            self._instants += 1
            self._clock.publish(encode_clock(turn.time))
        for name in turn.participants:
            self._participants[name].take_turn(self.sequence, turn.time, turn.phase, self.sent)

    def _give_back(self, *, failed: bool = False) -> None:
        if not self.active:
            return
        self.active = False
        self._timer.cancel()
        for participant in self._participants.values():
            participant.answer(self.sequence)
        with self._lock:
            self._keeper, self._kept = None, {}
            place = *self._agenda.place, int(failed), self._instants
            self._publish(self._participants.values(), (LED, *place))
