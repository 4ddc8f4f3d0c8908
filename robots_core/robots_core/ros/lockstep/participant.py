"""Participant: a node's part in a lock-step run."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, Final

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Int64MultiArray, String

from robots_core.ros.lockstep.agenda import LockstepError
from robots_core.ros.lockstep.counted_endpoints import (
    ALL,
    DEPTH,
    NO_PUBLISHER_EVENTS,
    NO_SUBSCRIPTION_EVENTS,
    POLLED_DEPTH,
    CountedPublisher,
    Counts,
    NeverExecuted,
    count_client,
    count_service,
    counted_callback,
    is_latched,
    is_matched,
    reliable,
)
from robots_core.ros.lockstep.lead import Lead
from robots_core.ros.lockstep.phases import NANOSECONDS, START, Phase
from robots_core.ros.lockstep.protocol import (
    GO,
    LEAD,
    OVER,
    PARTICIPANTS,
    RELEASE,
    REPORT,
    ROSTER,
    TIME,
    Announcement,
    Endpoint,
    Kind,
    Roster,
    as_json,
    decode,
    encode_reports,
)
from robots_core.ros.lockstep.timed_work import LockstepLoop, LockstepTimer, LockstepTurn, Works
from robots_core.ros.qos import STATE, STREAM
from robots_core.ros.running.clocks import set_clock

MATCHING_PERIOD: Final = 0.02  # s of the wall clock between checks, until all endpoints are matched
POLL: Final = 2e-5  # s
PATIENCE: Final = 30.0  # s of the wall clock for a message that was sent


class Participant:
    """Counts a node's messages, sets its clock, and does what is due when the coordinator permits it.

    A node that is no `TimedNode` creates with the methods of this class what shall be counted; what it
    creates itself is not waited for. Subscriptions are created before the node is spun. Time is `START` until
    the run begins; messages published before are sent then.

    Callbacks run as messages arrive, and time stands still meanwhile. Work that continues in a thread of the
    node's own after the callback that gave it has returned holds `busy` as long as it continues; what it
    publishes without is not waited for.

    Args:
        node: The node; it must not follow `/clock` itself.
    """

    def __init__(self, node: Node) -> None:
        self.node = node
        self.name: Final[str] = node.get_fully_qualified_name()
        self.time = START
        """The present instant, ns."""
        self.started = False
        """The run has begun."""
        self._sequence = 0
        self._answered = 0
        self._number: int | None = None
        self._roster: Roster | None = None
        self.polled: dict[str, int] = {}
        """The topics that are polled, and where messages count them."""
        self._polled_counts: tuple[int, ...] = ()
        self._matched = 0  # version of the roster
        self._announced = Announcement('', ())
        self.counts = Counts()
        """Of its endpoints; a subscription that is destroyed is closed there."""
        self._works = Works()
        self._inside = self._busy = 0
        self._lock = threading.RLock()
        self._replies: list[Callable[[], None]] = []
        set_clock(node.get_clock(), START)
        # Endpoints of the protocol itself, whose messages are not counted.
        publisher = partial(Node.create_publisher, node, event_callbacks=NO_PUBLISHER_EVENTS)
        subscription = partial(Node.create_subscription, node, event_callbacks=NO_SUBSCRIPTION_EVENTS)
        self._participants = publisher(String, PARTICIPANTS, STATE)
        self.reports: Any = publisher(Int64MultiArray, REPORT, ALL)
        """Publisher of the reports."""
        self._after_replies = node.create_guard_condition(self._handle_replies)
        self.wake: Callable[[], None] = self._after_replies.trigger
        """Wakes the executor."""
        self.lead: Lead | None = None
        """That of several participants of a process."""
        self._times: Any = subscription(
            Int64MultiArray, TIME, lambda _: None, STREAM, callback_group=NeverExecuted(), raw=True
        )
        self._go: Any = subscription(Int64MultiArray, f'{self.name}/{GO}', self._on_go, ALL, raw=True)
        subscription(String, ROSTER, self._on_roster, STATE)
        self._matching = Node.create_timer(
            node, MATCHING_PERIOD, self._match, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    @property
    def members(self) -> Mapping[str, Sequence[Endpoint]]:
        """Endpoints of all participants by their full names; empty until the coordinator was found."""
        return {} if self._roster is None else self._roster.participants

    # -- what is counted -----------------------------------------------------------------------------

    def create_publisher(self, message_type: Any, topic: str, qos: QoSProfile | int, **options: Any) -> Any:
        """As `Node.create_publisher`, reliable; messages are held back until all subscriptions match."""
        qos = reliable(qos, DEPTH)
        options['event_callbacks'] = NO_PUBLISHER_EVENTS  # they follow the machine's clock
        publisher: Any = Node.create_publisher(
            self.node, message_type, topic, qos, publisher_class=CountedPublisher, **options
        )
        publisher.count(
            self, self._add('publisher', publisher.topic_name, publisher, latched=is_latched(qos))
        )
        if self.started:
            self._change_busy(1)
        return publisher

    def create_subscription(
        self, message_type: Any, topic: str, callback: Any, qos: QoSProfile | int, **options: Any
    ) -> Any:
        """As `Node.create_subscription`, reliable and with a deep queue.

        One that is created after the start does not hold time until it has received everything.
        """
        polled = isinstance(options.get('callback_group'), NeverExecuted)
        qos = reliable(qos, POLLED_DEPTH if polled else DEPTH)
        options['event_callbacks'] = NO_SUBSCRIPTION_EVENTS
        kind: Kind = 'polled' if polled else 'subscription'
        index = -1 if self.started else len(self.counts.endpoints)
        if not polled:
            callback = counted_callback(callback, self, index)
        subscription = Node.create_subscription(self.node, message_type, topic, callback, qos, **options)
        if not self.started:
            self._add(kind, subscription.topic_name, subscription, latched=is_latched(qos))
        return subscription

    def create_service(self, service_type: Any, name: str, callback: Any, **options: Any) -> Any:
        """As `Node.create_service`."""
        service = Node.create_service(self.node, service_type, name, callback, **options)
        count_service(service, self, self._add('service', service.service_name, service))
        return service

    def create_client(self, service_type: Any, name: str, **options: Any) -> Any:
        """As `Node.create_client`; time stands still until a service of a participant has answered."""
        client = Node.create_client(self.node, service_type, name, **options)
        index = self._add('requests', client.service_name, client)
        self._add('replies', client.service_name, client)
        count_client(client, self, index)
        return client

    def is_behind(self, topic: str, sequence_number: int) -> bool:
        """More messages were sent on a polled topic before this phase than its newest one's number says."""
        self._update()
        place = self.polled.get(topic)
        if place is None or place >= len(self._polled_counts):
            return False
        return sequence_number < self._polled_counts[place]

    # -- what is due ---------------------------------------------------------------------------------

    def create_timer(
        self, period: float, callback: Callable[[], object], *, phase: Phase, autostart: bool = True
    ) -> LockstepTimer:
        """A timer with a period in s; first due one period from now."""
        timer = LockstepTimer(
            round(period * NANOSECONDS), callback, phase=phase, now=lambda: self.time, autostart=autostart
        )
        self._works.add(timer)
        return timer

    def start_loop(
        self,
        work: Callable[[float], None],
        *,
        period: float,
        phase: Phase,
        next_time: Callable[[], float] | None = None,
    ) -> LockstepLoop:
        """Call `work(now)` at the multiples of a period (s) from the start on; see `LockstepLoop`."""
        loop = LockstepLoop(
            work,
            period=round(period * NANOSECONDS),
            phase=phase,
            first=self.time + 1 if self.started else START,
            next_time=next_time,
        )
        self._works.add(loop)
        return loop

    def create_turn(self, work: Callable[[float], None], *, phase: Phase) -> LockstepTurn:
        """Work that is done in a phase of instants that the node requests."""
        turn = LockstepTurn(work, phase=phase, asked=self._report_unless_inside)
        self._works.add(turn)
        return turn

    @contextmanager
    def busy(self) -> Iterator[None]:
        """Time stands still, whatever the other nodes do; from any thread."""
        self._change_busy(1)
        try:
            yield
        finally:
            self._change_busy(-1)

    def _change_busy(self, change: int) -> None:
        with self._lock:
            self._busy += change
        self._report_unless_inside()

    # -- what counted endpoints call, in the executor's thread but for `sent` ------------------------

    def sent(self, index: int) -> None:
        """A message is being sent."""
        self.counts.sent(index)
        if not self._busy:
            self._report_unless_inside()

    def received(self, index: int) -> None:
        """A message was handled."""
        if index >= 0:
            self.counts.received(index)

    def enter(self) -> None:
        """A callback begins: the time is brought up to date, and reports wait until it ends."""
        self._update()
        self._inside += 1

    def leave(self) -> None:
        """A callback has ended."""
        self._inside -= 1
        self._report_unless_inside()

    def _report_unless_inside(self) -> None:
        if not self._inside and self._number is not None and self.started:
            if self.lead is not None:
                self.lead.send(self)
                return
            with self._lock:
                self.reports.publish(encode_reports([self.report()]))

    def report(self) -> list[int]:
        """Report for the coordinator, without the counts that were sent before."""
        assert self._number is not None
        with self._lock:
            return [
                self._number,
                self._answered,
                int(self._busy > 0),
                *self._works.due(),
                *self.counts.changes(),
            ]

    # -- the coordinator's messages ----------------------------------------------------------------------

    def _on_go(self, data: bytes) -> None:
        sequence, now, phase, *counts = decode(data)
        if phase == LEAD and self.lead is not None:
            self.lead.begin(sequence, now, counts[0])
        else:
            self.take_turn(sequence, now, phase, counts)

    def answer(self, sequence: int) -> None:
        """Have a turn answered, and all counts, in the next report."""
        self._answered = sequence
        self.counts.forget()

    def take_turn(self, sequence: int, now: int, phase: int, counts: Sequence[int]) -> None:
        """Do what is due in a phase of an instant (ns)."""
        self._inside += 1
        self._set_time(sequence, now, counts)
        if phase == RELEASE:
            self.started = True
            for entity in self.counts.entities:
                if isinstance(entity, CountedPublisher):
                    entity.release()
        elif phase == OVER:
            self._works.pass_over(now)
        else:
            self._works.run(phase, now)
        self._answered = sequence
        self.leave()

    def _update(self) -> None:
        lead = self.lead
        if lead is not None and lead.active:
            self._set_time(lead.sequence, lead.time, lead.sent)
            return
        taken = self._times.handle.take_message(Int64MultiArray, True)  # raw
        if taken is not None:
            sequence, now, *counts = decode(taken[0])
            self._set_time(sequence, now, counts)

    def _set_time(self, sequence: int, now: int, counts: Sequence[int]) -> None:
        if sequence < self._sequence:  # two topics need not come in the order in which they were sent
            return
        self._sequence, self._polled_counts = sequence, tuple(counts)
        if now != self.time:
            self.time = now
            set_clock(self.node.get_clock(), now)

    def wait_for_message(self, topic: str, deadline: float) -> None:
        """Wait a little for the middleware.

        Raises:
            LockstepError: the deadline is over, s of `time.monotonic`.
        """
        if time.monotonic() > deadline:
            raise LockstepError(f'what was sent on {topic} has not reached {self.name} within {PATIENCE:g} s')
        time.sleep(POLL)

    def _handle_replies(self) -> None:
        while self._replies:
            self._replies.pop(0)()

    def after_callbacks(self, function: Callable[[], None]) -> None:
        """Call a function in the executor's thread, after those that wait there: callbacks of replies do."""
        self._replies.append(function)
        self._after_replies.trigger()

    # -- joining -----------------------------------------------------------------------------------------

    def _add(self, kind: Kind, name: str, entity: Any, *, latched: bool = False) -> int:
        index = self.counts.add(Endpoint(kind, name, latched), entity)
        self._matching.reset()
        return index

    def _on_roster(self, message: String) -> None:
        roster = Roster.from_json(message.data)
        outdated = self._roster is not None and roster.version < self._roster.version
        if outdated or self.name not in roster.participants:
            return
        self._roster = roster
        self._number = list(roster.participants).index(self.name)
        self.polled = {topic: place for place, topic in enumerate(roster.polled)}
        if not self.started:
            self._matching.reset()

    def _match(self) -> None:
        """Announce what is new, and look whether all endpoints are matched."""
        if self._roster is not None and self._is_matched(self._roster):
            self._matched = self._roster.version
            self._matching.cancel()
        leader = '' if self.lead is None else self.lead.name
        announcement = Announcement(self.name, tuple(self.counts.endpoints), self._matched, leader)
        if announcement != self._announced:
            self._announced = announcement
            self._participants.publish(String(data=as_json(announcement)))

    def _is_matched(self, roster: Roster) -> bool:
        """All has been found in the network that has to be. Releases late publishers."""
        if not (
            self.reports.get_subscription_count()
            and self._go.get_publisher_count()
            and self._times.get_publisher_count()
        ):
            return False
        if self.lead is not None and not self.lead.is_matched:
            return False
        for endpoint, entity in zip([*self.counts.endpoints], [*self.counts.entities], strict=False):
            held = endpoint.kind == 'publisher' and entity.held is not None
            if self.started and not held:
                continue
            if not is_matched(self.node, endpoint, entity, roster):
                return False
            if self.started:
                entity.release()
                self._change_busy(-1)
        return True
