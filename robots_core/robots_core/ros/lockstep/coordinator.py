"""Coordinator: lets simulated time advance when every participant has done what was due."""

import time
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, Final, Protocol

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock as ClockMessage
from std_msgs.msg import Int64MultiArray, String

from robots_core.errors import RobotsError
from robots_core.ros.lockstep.agenda import LockstepError, Reports
from robots_core.ros.lockstep.counted_endpoints import ALL
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.lockstep.protocol import (
    GO,
    LEAD,
    LED,
    PARTICIPANTS,
    RELEASE,
    REPORT,
    ROSTER,
    TIME,
    Announcement,
    Endpoint,
    Roster,
    as_json,
    decode_reports,
    encode,
    encode_clock,
)
from robots_core.ros.qos import STATE, STREAM

JOINING_PATIENCE: Final = 120.0  # s of the wall clock: models and compiled code take long to load
PATIENCE: Final = 30.0  # s of the wall clock
WATCH_PERIOD: Final = 0.1  # s of the wall clock
# Time goes on while the recorder has what was sent before the last check. What is lost on its way can be
# sent again until `DEPTH` messages of its topic have followed.
RECORDER_PERIOD: Final = 0.05  # s of the wall clock
LATCHED_BY_MANY: Final = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Recorder(Protocol):
    """A node that takes no part in a run, and records all that is sent in it."""

    def get_fully_qualified_name(self) -> str:
        """The node's name, with its namespace."""

    def recorded(self, topics: Iterable[str]) -> frozenset[str] | None:
        """Those of the topics that it records; None while it is not subscribed to all of these."""

    def expect_instants(self, count: int, last: int) -> None:
        """So many instants have begun, the last one at this time (ns); their clocks may be on the way."""

    def missing(self, sent: Mapping[str, int]) -> str:
        """What has not come of so many messages by topic; '' for nothing that it still waits for."""


class Coordinator:
    """Goes through the phases of one instant after the other (see `Phase`), each as soon as all is quiet.

    The run begins at `START` when all expected participants have joined and found each other. While it is
    held, the present instant continues, with whatever services are called in it, and time stands still.

    All methods are called in the thread that spins the node.

    Args:
        node: Owner of the topics; spun by the caller.
        expected: Names of the participants, each with its namespace; others may join too before the start.
        on_error: Called once when the run cannot continue; the default raises the error where the node spins.
        on_held: Called when nothing more is due at this instant and the run is held.
        held: The run is held from the beginning on.
        recorder: The run begins when all publishers have found its subscriptions, and does not run ahead of
            it.
        callers: Participants that only call services.
        patience: Longest time without any progress, s of the wall clock.
        joining_patience: Longest time until the run begins, s of the wall clock.
    """

    def __init__(
        self,
        node: Node,
        expected: Iterable[str],
        *,
        on_error: Callable[[LockstepError], None] | None = None,
        on_held: Callable[[], None] = lambda: None,
        held: bool = False,
        recorder: Recorder | None = None,
        callers: Collection[str] = (),
        patience: float = PATIENCE,
        joining_patience: float = JOINING_PATIENCE,
    ) -> None:
        self.instants = 0
        """Instants so far, without those in which a process had the lead."""
        self._node, self._expected = node, frozenset(expected)
        self._on_error, self._on_held = on_error, on_held
        self._patience, self._joining_patience = patience, joining_patience
        self._held, self._reported_held = held, False
        self._recorder, self._recorded = recorder, frozenset[str]()
        self._awaited: Mapping[str, int] = {}
        self._recorder_checked = 0.0
        self._callers, self._may_lead = callers, True
        self._led_instants = 0
        self._reported = Reports()
        self._traffic, self._agenda = self._reported.traffic, self._reported.agenda
        self._announced: dict[str, Announcement] = {}
        self._names: list[str] = []
        # Later than any version of an earlier run, whose latched roster may still be on its way.
        self._roster = Roster(time.time_ns(), {}, ())
        self._gos: dict[str, Any] = {}
        self.started = False
        """All participants have joined and time may advance."""
        self._sequence, self._ended = 0, False
        self._outstanding: set[str] = set()
        self._progress = time.monotonic()
        self._published_time = -1

        self._rosters = node.create_publisher(String, ROSTER, STATE)
        self._times = node.create_publisher(Int64MultiArray, TIME, STREAM)
        self._clock = node.create_publisher(ClockMessage, '/clock', ALL)
        node.create_subscription(String, PARTICIPANTS, self._on_announcement, LATCHED_BY_MANY)
        self._reports = node.create_subscription(Int64MultiArray, REPORT, self._on_report, ALL, raw=True)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._watch = node.create_timer(WATCH_PERIOD, self._check_progress, clock=steady)

    @property
    def time(self) -> int:
        """The present instant, ns."""
        return self._agenda.time

    @property
    def missing(self) -> list[str]:
        """Expected participants that have not joined."""
        return sorted(self._expected - self._announced.keys())

    @property
    def sent(self) -> dict[str, int]:
        """Messages sent so far, by topic; those of the clock and the recorded topics."""
        sent = {topic: self._traffic.sent(topic) for topic in self._recorded}
        return sent | {'/clock': self.instants + self._led_instants}

    def hold(self) -> None:
        """Let no time pass after the present instant."""
        self._held = True
        self._go_on()

    def release(self) -> None:
        """Let time pass."""
        self._held = self._reported_held = False
        self._go_on()

    def end(self) -> None:
        """End the run: time stands still for good, and no participant is waited for."""
        if self._ended:
            return
        self._ended = True
        self._watch.cancel()
        # Participants of a later run must not read the latched roster of this one.
        self._node.destroy_publisher(self._rosters)

    # -- joining -----------------------------------------------------------------------------------------

    def _on_announcement(self, message: String) -> None:
        if self._ended:
            return
        announcement = Announcement.from_json(message.data)
        name = announcement.name
        if self.started and name not in self._announced:
            self._node.get_logger().warning(f'{name} is too late to take part: the run has begun')
            return
        before = self._announced.get(name)
        self._announced[name] = announcement
        if before is None:
            self._names.append(name)
            self._gos[name] = self._node.create_publisher(Int64MultiArray, f'{name}/{GO}', ALL)
        try:
            if before is None or before.endpoints != announcement.endpoints:
                self._traffic.join(name, announcement.endpoints)
                self._send_roster()
                self._go_on()
            self._begin_when_matched()
        except RobotsError as error:
            self._fail(LockstepError(error.message))

    def _send_roster(self) -> None:
        participants = {name: self._announced[name].endpoints for name in self._names}
        if self._recorder is not None:  # behind all that have numbers
            endpoints = tuple(Endpoint('recorded', topic) for topic in sorted(self._recorded))
            participants[self._recorder.get_fully_qualified_name()] = endpoints
        self._roster = Roster(self._roster.version + 1, participants, tuple(self._traffic.polled))
        self._rosters.publish(String(data=as_json(self._roster)))
        self._progress = time.monotonic()

    def _is_recorded(self) -> bool:
        """The recorder's subscriptions to all topics are in the roster."""
        if self._recorder is None:
            return True
        recorded = self._recorder.recorded(self._traffic.publishers)
        if recorded is not None and recorded != self._recorded:
            self._recorded = recorded
            self._send_roster()
        return recorded is not None

    def _begin_when_matched(self) -> None:
        if self.started or self.missing or not self._is_recorded():
            return
        if any(one.matched != self._roster.version for one in self._announced.values()):
            return
        # A volatile reader that matches its writer late does not get what was sent before.
        count = len(self._names)
        if self._reports.get_publisher_count() < count or self._times.get_subscription_count() < count:
            return
        if any(go.get_subscription_count() == 0 for go in self._gos.values()):
            return
        if self._clock.get_subscription_count() < len(self._node.get_subscriptions_info_by_topic('/clock')):
            return
        self.started = True
        self._give_turn(RELEASE, self._names)

    # -- the lead -------------------------------------------------------------------------------------------

    @property
    def _leader(self) -> str:
        """The leader of the only process in which something is due; '' for none."""
        leaders = {one.leader for name, one in self._announced.items() if name not in self._callers}
        return leaders.pop() if len(leaders) == 1 and self._may_lead else ''

    def _give_lead(self, leader: str) -> None:
        self._sequence += 1
        self._outstanding.update(name for name in self._names if name not in self._callers)
        now, phase = self._agenda.place
        self._gos[leader].publish(encode([self._sequence, now, LEAD, phase]))

    def _on_led(self, time: int, phase: int, failed: int, instants: int) -> None:
        self._published_time = time
        self._agenda.resume(time, phase)
        self._may_lead &= not failed
        self._led_instants += instants
        if self._recorder is not None:
            self._recorder.expect_instants(self.instants + self._led_instants, time)

    # -- running -----------------------------------------------------------------------------------------

    def _give_turn(self, phase: int, names: Iterable[str]) -> None:
        self._sequence += 1
        now = self._agenda.time
        sent = [self._traffic.sent(topic) for topic in self._roster.polled]
        advanced = now != self._published_time
        if advanced:  # before whatever is sent at this instant
            self._published_time = now
            self.instants += 1
            self._clock.publish(encode_clock(now))
        if advanced or phase > Phase.DRIVES:
            self._times.publish(encode([self._sequence, now, *sent]))
        go = encode([self._sequence, now, phase, *sent])
        self._outstanding.update(names)
        for name in names:
            self._gos[name].publish(go)

    def _on_report(self, data: bytes) -> None:
        self._progress = time.monotonic()
        for number, answered, *numbers in decode_reports(data):
            if number == LED:
                self._on_led(answered, *numbers)
                continue
            name = self._names[number]
            self._reported.read(name, *numbers)
            if answered == self._sequence:
                self._outstanding.discard(name)
        self._go_on()

    @property
    def _quiet(self) -> bool:
        return not self._outstanding and self._reported.quiet

    def _go_on(self) -> None:
        if not self.started or self._ended or not self._quiet or self._recorder_is_behind():
            return
        if not self._held and (leader := self._leader) and not self._agenda.empty:
            self._give_lead(leader)
            return
        try:
            turn = self._agenda.next_turn(advance=not self._held)
        except LockstepError as error:
            self._fail(error)
            return
        if turn is not None:
            self._reported_held = False
            self._give_turn(turn.phase, turn.participants)
        elif self._held and not self._reported_held:
            self._reported_held = True
            self._on_held()

    def _recorder_is_behind(self) -> bool:
        now = time.monotonic()
        if self._recorder is None or now < self._recorder_checked + RECORDER_PERIOD:
            return False
        if self._recorder.missing(self._awaited):
            return True
        self._awaited, self._recorder_checked = self.sent, now
        return False

    # -- patience ----------------------------------------------------------------------------------------

    def _check_progress(self) -> None:
        self._begin_when_matched()
        idle = time.monotonic() - self._progress
        if not self.started:
            if idle > self._joining_patience:
                self._fail(LockstepError(f'{self._not_joined()} within {self._joining_patience:g} s'))
        elif idle > self._patience and (not self._quiet or self._recorder_is_behind()):
            self._fail(LockstepError(f'{self._not_done()} within {self._patience:g} s'))
        else:
            self._go_on()

    def _not_joined(self) -> str:
        if self.missing:
            return f'{", ".join(self.missing)} did not join the lock-step run'
        if not self._is_recorded():
            return 'the recorder did not find all topics'
        unmatched = [one.name for one in self._announced.values() if one.matched != self._roster.version]
        return f'{", ".join(unmatched) or "the coordinator"} did not find all topics and services'

    def _not_done(self) -> str:
        at = f'at {1e-9 * self._agenda.time:.9f} s'
        if self._outstanding:
            return f'{", ".join(sorted(self._outstanding))} did not do what was due {at}'
        if self._reported.busy:
            return f'{", ".join(sorted(self._reported.busy))} did not end the work under way {at}'
        missing = self._traffic.on_the_way()
        if self._recorder is not None and self._recorder_is_behind():
            missing.append(f'the recorder: {self._recorder.missing(self._awaited)}')
        return f'{"; ".join(missing)} {at}: this did not change'

    def _fail(self, error: LockstepError) -> None:
        self.end()
        if self._on_error is None:
            raise error
        self._on_error(error)
