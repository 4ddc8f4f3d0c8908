"""Heartbeats: a process that dies or freezes is noticed by the nodes that depend on it."""

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from std_msgs.msg import UInt64

from robots_core.errors import NotNowError
from robots_core.periodic.periodic_thread import PeriodicThread
from robots_core.periodic.realtime import processor_share, processor_share_in_silence
from robots_core.periodic.watchdog import CHECKS, LONGEST, SHORTEST, WATCHDOG, Watchdog, checked_watchdog
from robots_core.ros.lockstep.counted_endpoints import NeverExecuted
from robots_core.ros.peers.identified_messages import IdentifiedMessages, publishers_are_identified
from robots_core.ros.peers.presence import Sender, publishers_of
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.timed_node import OFTEN, TimedNode
from robots_core.wording.safety_note import NOT_CERTIFIED

HEARTBEAT: Final = 'heartbeat'
MOST_CHECKS: Final = 8 * CHECKS
"""Looks within the timeout at a node that is about to be lost."""
LONGEST_BETWEEN_CHECKS: Final = 0.2
"""s. A process that dies is not replaced sooner: the signs of life of both are seen."""
ROUNDING: Final = 1e-4
"""s, of the times of a loop that adds up its periods; far below one of them."""
NAMESAKE_PERIOD: Final = 0.2  # s
NAMESAKE_BEATS: Final = QoSProfile(depth=50, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Those of two nodes with one name in a period, and of some before."""


class Heartbeat:
    """Publishes `~/heartbeat` from a thread of its own: callbacks that take long do not hold it up.

    Its number is the time when it began: a process that was restarted has another.

    In simulated time none is needed: lock-step misses a lost process by itself.

    Args:
        node: The node, complete.
        alive: Whether it has a sign of life to give at a time, s; called from the thread.
    """

    def __init__(self, node: TimedNode, alive: Callable[[float], bool] = lambda _: True) -> None:
        self._node, self._alive = node, alive
        self.began: Final = time.time_ns()
        """On the clock of the system, which machines share."""
        self._publisher = make_publisher(node, UInt64, f'~/{HEARTBEAT}')
        self._message = serialize_message(UInt64(data=self.began))
        self._last = math.inf
        node.silence = lambda: max(0.0, time.monotonic() - self._last)
        self._longest = SHORTEST + node.heartbeat_period - OFTEN
        self._thread = PeriodicThread(
            self.beat, period=node.heartbeat_period, name=HEARTBEAT, on_error=node.thread_failed
        )
        self._thread.start()

    def beat(self, now: float) -> None:
        """Publish a sign of life; after a long silence `TimedNode.held_up` is called first."""
        if not self._alive(now):
            return
        silence = now - self._last
        if silence >= self._longest:
            self._node.held_up(silence)
        self._last = now
        self._publisher.publish(self._message)

    def stop(self) -> None:
        """End it before the node is destroyed."""
        self._thread.stop()


class HeartbeatWatch:
    """Notices that other nodes, once seen, have died or frozen; calls back in the executor's thread.

    A node is seen with its first sign of life, or `by_discovery` as soon as the publisher of these is found.
    One that comes back as another process before its silence was noticed has been lost too.

    In simulated time, and with a timeout of 0, none is ever lost.

    Args:
        node: The node that watches.
        names: Names of the nodes, in the namespace of this one.
        timeout: See `Watchdog`, s.
        on_change: Called with a node's name and, when it is lost, a reason for a person; '' when it is back.
        on_seen: Called with a node's name when it is seen.
        by_discovery: A node that dies between its discovery and its first sign of life is lost.
        loop_period: Of a loop of the node that calls `poll` whenever it is `due`, s. If it is too long for
            that, as by default, a timer looks.
    """

    def __init__(
        self,
        node: TimedNode,
        names: Sequence[str],
        timeout: float,
        on_change: Callable[[str, str], None],
        on_seen: Callable[[str], None] = lambda _: None,
        *,
        by_discovery: bool = False,
        loop_period: float = math.inf,
    ) -> None:
        self._node, self._timeout, self._on_change, self._on_seen = node, timeout, on_change, on_seen
        self._by_discovery = by_discovery
        self._changes: deque[Callable[[], object]] = deque()
        self.due = math.inf
        """When a loop is to call `poll` next, s on the clock of the node."""
        self._watched: dict[str, tuple[PolledSubscription, Watchdog]] = {}
        self._processes: dict[str, bytes] = {}  # their last signs of life
        if timeout == 0.0 or node.simulated_time:
            return
        for name in names:
            beats = PolledSubscription(node, UInt64, f'{name}/{HEARTBEAT}', raw=True)
            self._watched[name] = beats, Watchdog(timeout, processor_share)
        self._period = min(timeout / CHECKS, LONGEST_BETWEEN_CHECKS)
        if loop_period <= timeout / MOST_CHECKS:
            self.due = -math.inf
            self._changed = node.create_guard_condition(self._call_back)
        else:
            self._timer = node.create_timer(self._period, self._check)

    @property
    def lost(self) -> tuple[str, ...]:
        """Names of the nodes that are lost now."""
        return tuple(name for name, (_, watchdog) in self._watched.items() if watchdog.lost)

    @property
    def unseen(self) -> tuple[str, ...]:
        """Names of the nodes that were not seen yet."""
        return tuple(name for name, (_, watchdog) in self._watched.items() if not watchdog.seen)

    def poll(self, now: float) -> None:
        """Look, in the thread of a loop; `now` in s, on the clock of the node."""
        self.due = now + self._until_next_look(self._look(now)) - ROUNDING
        if self._changes:
            self._changed.trigger()

    def _check(self) -> None:
        self._check_again(self._look(self._node.now()))
        self._call_back()

    def _check_again(self, remaining: float) -> None:
        period = round(1e9 * self._until_next_look(remaining))
        if period != self._timer.timer_period_ns:
            self._timer.timer_period_ns = period
            self._timer.reset()

    def _until_next_look(self, remaining: float) -> float:
        """The regular time, or until a node is lost by its silence, s."""
        return min(self._period, max(remaining, self._timeout / MOST_CHECKS))

    def _call_back(self) -> None:
        while self._changes:
            self._changes.popleft()()

    def _look(self, now: float) -> float:
        """Look, and return how much longer the one that is silent for longest may be, s."""
        remaining = math.inf
        for name, (beats, watchdog) in self._watched.items():
            before, seen = watchdog.lost, watchdog.seen
            beat, age = _newest(beats)
            if self._by_discovery and not seen and beats.publishers:
                watchdog.expect()
            if beat is not None and beat != self._processes.setdefault(name, beat):
                self._processes[name] = beat
                if not before:
                    self._report_change(name, f'{name} has died and was started anew')
                    before = True
            if watchdog.check(now, alive=beat is not None, age=age):
                reason = f'no sign of life of {name} for {self._timeout:g} s: is it still running?'
                self._report_change(name, reason)
            elif before and not watchdog.lost:
                self._report_change(name, '')
            if watchdog.seen and not seen:
                self._changes.append(partial(self._on_seen, name))
            remaining = min(remaining, watchdog.remaining)
        return remaining

    def _report_change(self, name: str, reason: str) -> None:
        self._changes.append(partial(self._on_change, name, reason))


class NamesakeWatch:
    """Ends the later one of two nodes with one name, by the numbers of their heartbeats.

    A dead node sends none, so one that is started after it stays. Only publishers of a node with the same
    full name count, and only where the middleware identifies publishers.
    """

    def __init__(self, node: TimedNode, heartbeat: Heartbeat) -> None:
        self._node, self._began = node, heartbeat.began
        if not publishers_are_identified():
            return
        topic = f'{node.get_name()}/{HEARTBEAT}'
        subscription = node.create_subscription(
            UInt64, topic, lambda _: None, NAMESAKE_BEATS, callback_group=NeverExecuted()
        )
        self._beats = IdentifiedMessages(subscription)
        self._publishers = partial(publishers_of, node, topic)
        node.create_timer(NAMESAKE_PERIOD, self._check)

    def _check(self) -> None:
        earlier: set[bytes] = set()
        while (taken := self._beats.take()) is not None:
            beat, publisher = taken
            if beat.data < self._began:
                earlier.add(publisher)
        if not earlier:
            return
        name, publishers = self._node.get_fully_qualified_name(), self._publishers()
        if any(publishers.get(publisher) == name for publisher in earlier):
            raise NotNowError(
                f'{name} runs already; a second one would command the same robot. End the first one, or give '
                'this one another namespace'
            )


class FreshCommands:
    """A process that was frozen for longer than the watchdog has been missed by all others.

    They have stopped the robot, and programs have failed. What they had commanded still waits for the
    process, and its own threads continue with what they were about to command: no motion may come of that
    when it runs again.

    Args:
        node: That gets or gives commands.
        watchdog: Silence after which the others miss it, s; 0: they do not.
    """

    def __init__(self, node: TimedNode, watchdog: float) -> None:
        self._node, self._watchdog = node, watchdog
        self._resumed = 0  # ns on the clock of the system: until then it was held up last

    def held_up(self, silence: float) -> bool:
        """The process runs again after a silence (s), in which the others have missed it; from any thread."""
        missed = self.missed(silence)
        if missed:
            self._resumed = time.time_ns()
        return missed

    def missed(self, silence: float | None = None) -> bool:
        """The process runs again after the others have missed it, by default with no sign of life since."""
        silence = self._node.silence() if silence is None else silence
        # Looked at for every command: the share is read only after a silence.
        return silence > self._watchdog > 0.0 and silence * processor_share_in_silence() > self._watchdog

    def check(self, sender: Sender) -> None:
        """Pass a command that was sent since.

        Raises:
            NotNowError: it was sent before.
        """
        if self.missed() or 0 < sender.time < self._resumed:
            raise NotNowError(
                f'{self._node.get_name()} was held up after this was commanded; command it again'
            )


def _newest(beats: PolledSubscription) -> tuple[bytes | None, float | None]:
    """The newest sign of life since the last call, and how long ago it came, s."""
    beat, age = None, None
    for taken, info in beats.take_all():
        beat, age = taken, 1e-9 * (time.time_ns() - info['received_timestamp'])
    return beat, age


def watchdog_parameter(node: RobotNode) -> float:
    """Declare parameter `watchdog` and return its value, s."""
    value: float = node.parameter(
        'watchdog',
        WATCHDOG,
        f'without a sign of life for this long another node is lost, s; 0: none is watched; {NOT_CERTIFIED}',
        bounds=(0.0, LONGEST),
        read=checked_watchdog,
    )
    return value
