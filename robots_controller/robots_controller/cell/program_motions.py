"""ProgramMotions: the motions of a program on their way to the planner and back."""

import threading
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Final

from robots_controller.cell.ports import PlannerPort
from robots_controller.program.clock import Clock
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError, RobotsError

# A node restarts in about this time; a motion that no node will end must not be waited for longer.
LOST_TIMEOUT: Final = 2.0  # s
# Motions on their way at once: fewer than the controller queues and than the middleware keeps of commands.
MOST_SENT: Final = 50


class ProgramMotions:
    """Motions in their order: sent when a planner listens, ended by their results or when no node is left.

    A motion is sent at once; the program commands the next one before its end only if they blend. Before a
    motion the planner gets the settings that it was commanded with, if they differ from its own. Safe from
    any thread.

    Args:
        planner: The planner.
        cancel: Stops the robot and gives up the controller's motions.
        clock: The program's time.
        planner_timeout: Longest wait for a planner, s.
        on_sent: A motion is being sent, with its id.
        on_blocked: An obstacle has stopped the motion with this id; its result follows.
        on_result: A motion has ended; its id ('' if it was not sent), and None, or why the robot is not at
            the target.
    """

    def __init__(
        self,
        planner: PlannerPort,
        cancel: Callable[[], object],
        clock: Clock,
        *,
        planner_timeout: float,
        on_sent: Callable[[str, MotionCommand], None],
        on_result: Callable[[str, MotionCommand, RobotsError | None], None],
        on_blocked: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._planner, self._cancel, self._clock = planner, cancel, clock
        self._planner_timeout = planner_timeout
        self._on_sent, self._on_blocked, self._on_result = on_sent, on_blocked, on_result
        # Entered again by an answer of the planner that is there at once.
        self._lock = threading.RLock()
        self._unsent: deque[MotionCommand] = deque()
        self._sent: dict[str, MotionCommand] = {}  # by id, oldest first
        self._blocked: dict[str, tuple[float, MotionResult]] = {}  # by id: since when, s, and by what
        self._configuring: MotionCommand | None = None  # whose settings are on their way
        self._flush = False
        self._since = 0.0  # when the command came, or when all its followers were last present
        self._followers: dict[bytes, str] = {}
        self._canceling = False
        self._planner_lost = ''

    def send(self, command: MotionCommand) -> None:
        """Send a motion, at once or as soon as a planner listens."""
        with self._lock:
            if not self._unsent:
                self._since = self._clock.now()
            self._unsent.append(command)
            self._canceling = self._flush = False
            lost = self._planner_lost
            if not lost:
                self._send_planned()
        if lost:
            self._give_up(lost)

    @property
    def going_on(self) -> bool:
        """Motions are under way that were not given up."""
        with self._lock:
            return bool(self._sent or self._unsent) and not self._canceling

    @property
    def timed(self) -> bool:
        """`watch` may act by itself."""
        with self._lock:
            return self._canceling or bool(self._blocked) or bool(self._unsent and not self._full)

    def flush(self) -> None:
        """No motion follows for now: a planner need not wait for the next one to blend into."""
        with self._lock:
            self._flush = True
            self._send_planned()

    def cancel(self) -> None:
        """Give up all motions; the results of those that were sent still come."""
        with self._lock:
            # A motion that is being planned reaches the controller after this request: `watch` repeats it.
            self._canceling = bool(self._sent)
            unsent = list(self._unsent)
            self._unsent.clear()
            self._configuring = None
        self._cancel()
        for command in unsent:
            self._on_result('', command, PlanningError('canceled before it began'))

    def result(self, result: MotionResult) -> None:
        """A motion has ended."""
        with self._lock:
            if result.blocked and result.id in self._sent:
                # The planner leads the motion around, or ends it and names the obstacle.
                self._blocked[result.id] = (self._clock.now(), result)
                self._on_blocked(result.id)
                return
            self._blocked.pop(result.id, None)
            command = self._sent.pop(result.id, None)
            if command is None:
                return
            before = {}
            if result.ok:  # those before it have ended too
                before = {id_: one for id_, one in self._sent.items() if _number(id_) < _number(result.id)}
                for id_ in before:
                    del self._sent[id_]
            if not self._sent:
                self._canceling = False
            if result.ok:
                self._since = self._clock.now()
                self._send_planned()
        for id_, one in before.items():
            self._on_result(id_, one, None)
        self._on_result(result.id, command, result.error)

    def watch(self) -> None:
        """Send what waits for a planner, and give up motions that no node will end; called regularly."""
        with self._lock:
            now, canceling = self._clock.now(), self._canceling
            waiting = self._unsent and not self._full
            problem = self._unplanned(now) if waiting else self._lost(now) or self._unanswered(now)
        if problem:
            self._give_up(problem)
        elif canceling:
            self._cancel()

    def lose_planner(self, reason: str) -> None:
        """No planner plans and ends motions: give up all, and those that are commanded before it is back.

        Args:
            reason: For a person; '' when it is back.
        """
        self._planner_lost = reason
        if reason and self._sent:
            self._give_up(reason)

    def _give_up(self, reason: str) -> None:
        with self._lock:
            given_up = list(self._sent.items()) + [('', command) for command in self._unsent]
            for motions in (self._sent, self._unsent, self._blocked):
                motions.clear()
            self._configuring, self._canceling = None, False
        for id_, command in given_up:
            self._on_result(id_, command, PlanningError(reason))
        self._cancel()

    # -- inside, locked -------------------------------------------------------------------------

    @property
    def _full(self) -> bool:
        return len(self._sent) >= MOST_SENT

    def _send_planned(self) -> None:
        planner = self._planner
        while self._unsent and self._configuring is None and not self._full:
            command = self._unsent[0]
            if not planner.plans(command):
                return
            if planner.differs(command.settings):
                if not planner.configurable:
                    return
                self._configuring = command
                done = partial(self._configured, command)
                planner.configure(command.settings, done, moving=bool(self._sent))
                return
            self._send(self._unsent.popleft())
        if self._flush and not self._unsent and self._sent and not self._configuring and planner.configurable:
            self._flush = False
            last = next(reversed(self._sent.values()))
            planner.flush(last.settings)

    def _configured(self, command: MotionCommand, error: PlanningError | None) -> None:
        with self._lock:
            if self._configuring is not command:  # given up meanwhile
                return
            self._configuring = None
            if error is None:
                self._send(self._unsent.popleft())
                self._send_planned()
                return
            _, *following = self._unsent
            self._unsent.clear()
        self._on_result('', command, error)
        for one in following:
            self._on_result('', one, PlanningError(f'canceled before it began: {error}'))

    def _send(self, command: MotionCommand) -> None:
        id_ = self._planner.next_id()
        self._sent[id_] = command
        self._since, self._followers = self._clock.now(), dict(self._planner.followers())
        self._on_sent(id_, command)
        self._planner.command(id_, command)

    def _unplanned(self, now: float) -> str:
        self._send_planned()
        if not self._unsent or now - self._since < self._planner_timeout:
            return ''
        if self._configuring is not None:
            name = self._planner.name
            return f'{name} has not answered for {self._planner_timeout:g} s: is it still running?'
        return (
            f'no node plans {self._unsent[0].kind.topic} within {self._planner_timeout:g} s: '
            f'{self._planner.name} is not running, or in another namespace'
        )

    def _unanswered(self, now: float) -> str:
        """Why a blocked motion ends without a word of the planner, which is another one than ours."""
        if not self._blocked or any(replans(command) for command in self._sent.values()):
            return ''
        since, result = next(iter(self._blocked.values()))
        return result.message if now - since > self._planner_timeout else ''

    def _lost(self, now: float) -> str:
        """Why no node will end the motions that were sent.

        Heartbeats miss planning_node and controller_node sooner, see `lose_planner`. There are none with a
        watchdog of 0, in simulated time without lock-step, and of others' nodes in the place of these two.
        """
        if not self._sent:
            return ''
        present = self._planner.followers()
        known = set(self._followers.values())
        # A node that was started again has none of the motions, and the process before it can seem to be
        # present until its lease is over.
        self._followers |= {identity: name for identity, name in present.items() if name not in known}
        gone = known - {self._followers[identity] for identity in present.keys() & self._followers.keys()}
        if self._followers and not gone:
            self._since = now
        if now - self._since < LOST_TIMEOUT:
            return ''
        names = ', '.join(sorted(gone)) or 'every node that could end the motion'
        return f'{names} has been gone for {LOST_TIMEOUT:g} s while the robot moved: is it still running?'


def replans(command: MotionCommand) -> bool:
    """Whether the planner leads a motion around what stops it."""
    return bool(command.settings.get('avoid')) and command.settings.get('on_blocked') == 'replan'


def _number(id_: str) -> int:
    return int(id_.replace('.', ''))
