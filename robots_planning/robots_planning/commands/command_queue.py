"""CommandQueue: which motions are commanded, planned and not over yet."""

from __future__ import annotations

import math
import threading
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

from robots_planning.commands.motion_plan import CommandChain, MotionPlan, QueuedCommand
from robots_planning.motion_settings import MotionSettings
from robots_planning.trajectory import Trajectory

# Motions that are planned at once. In a longer chain the next plan continues from the middle of them; a
# program has more than one and a half as many commands on their way.
WINDOW: Final = 32


class CommandQueue:
    """Collects blended commands to chains, and holds what runs. Safe to call from any thread.

    A motion that fails takes all with it that were commanded before it ended: after a stop the robot stands
    until somebody commands it again. A motion that an obstacle stops continues from there, with those after
    it, if its settings permit that.
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._held: list[QueuedCommand] = []
        self._goes_on = False
        self._known: dict[str, QueuedCommand | None] = {}  # in their order; None for a given trajectory
        self._around: list[CommandChain] = []  # stopped by an obstacle, to be planned before all others
        self._stale: set[str] = set()  # planned again before the controller has answered them
        self._running: dict[str, MotionPlan] = {}
        self._given_up: dict[str, MotionPlan] = {}  # with one before them; the controller's answers come
        self._failed_at = -float('inf')
        self._failed = ''  # why all is void that came before
        self._failures = 0

    # -- commands ------------------------------------------------------------------------------------

    def holds(self, id_: str) -> bool:
        """A command with this id has come and is not over."""
        with self._lock:
            return id_ in self._known

    def hold(self, command: QueuedCommand) -> CommandChain | None:
        """Take a command; returns what is to be planned now, None while more may be planned with it."""
        with self._lock:
            self._known[command.id] = command
            self._held.append(command)
            if not command.settings.blends:
                return self.release()
            if len(self._held) <= (WINDOW // 2 if self._goes_on else WINDOW):
                return None
            chain, self._held = CommandChain(tuple(self._held[:-1]), goes_on=True), self._held[-1:]
            self._goes_on = True
            return chain

    def chains(self, settings: MotionSettings) -> bool:
        """A command with these settings may continue in the chain of those held: the payload is the same."""
        with self._lock:
            return not self._held or self._held[-1].settings.payload == settings.payload

    def release(self) -> CommandChain | None:
        """The commands that were held, if any, as nothing follows them."""
        with self._lock:
            held, self._held, self._goes_on = tuple(self._held), [], False
            return CommandChain(held) if held else None

    def given_up(self, commands: Sequence[QueuedCommand]) -> str:
        """Why commands are void; '' if they are not."""
        with self._lock:
            if min(command.received for command in commands) < self._failed_at:
                return self._failed
            return ''

    def refused(self, id_: str) -> None:
        """A command was answered without a motion."""
        with self._lock:
            self._forget([id_])

    # -- motions -------------------------------------------------------------------------------------

    @property
    def running(self) -> tuple[MotionPlan, ...]:
        """Planned motions that have not ended, oldest first."""
        with self._lock:
            return tuple(self._running.values())

    @property
    def failures(self) -> int:
        """How many motions have not reached their targets; another one voids what was planned after it."""
        with self._lock:
            return self._failures

    def planned(self, motion: MotionPlan, failures: int) -> bool:
        """Take a motion into the queue.

        Args:
            motion: The plan.
            failures: Those that were known when it was planned.

        Returns:
            False if a motion has failed meanwhile: the plan starts where the robot will not be.
        """
        with self._lock:
            if failures != self._failures:
                return False
            for id_, before in self._running.items():
                if not before.ends.keys().isdisjoint(motion.ends):
                    self._running[id_] = before.without(motion.ends)
            self._running[motion.id] = motion
            return True

    def replaced(self, motion: MotionPlan) -> None:
        """A motion continues in the place of this one: what follows starts at that one's end."""
        with self._lock:
            self._running.pop(motion.id, None)
            self._forget(motion.ends)

    def ended(self, id_: str, *, ok: bool, at: float) -> MotionPlan | None:
        """A motion has ended; returns it if it is one of these, or was given up with one of them.

        Args:
            id_: The motion.
            ok: It reached its target.
            at: When, s; what was commanded until then is void if it did not.
        """
        with self._lock:
            motion = self._running.pop(id_, None)
            if motion is None:
                return self._given_up.pop(id_, None)
            self._forget(motion.ends)
            if not ok:
                self._fail(_given_up_with(id_), at)
            return motion

    def blocked(self, id_: str, progress: float) -> list[str] | None:
        """An obstacle has stopped a motion at a part of its plan, 0..1: have it planned from there.

        Returns:
            Ids of the commands in it that were done with; None if it may not go on, and nothing has changed.
        """
        with self._lock:
            motion = self._running.get(id_)
            if motion is None:
                return None
            left = motion.left(progress)
            first = self._known.get(left[0])
            if first is None or not first.may_replan:
                return None
            self._known[first.id] = replace(first, replans=first.replans + 1)
            passed = [one for one in motion.ends if one not in left]
            self._forget(passed)
            place = (motion.trajectory, progress * motion.trajectory.duration)
            waiting = [other for other in self._running.values() if other is not motion]
            own = left.index(id_) + 1  # what goes on around the obstacle is a motion with the same id
            later = [left[own:], *(list(other.ends) for other in waiting)]
            self._around += [self._chain(left[:own], place), *(self._chain(ids) for ids in later if ids)]
            self._stale.update(other.id for other in waiting)
            self._running.clear()
            self._failures += 1
            return passed

    def stale(self, id_: str) -> bool:
        """Whether a result is of a plan that waited behind a blocked motion and was replaced; true once."""
        with self._lock:
            known = id_ in self._stale
            self._stale.discard(id_)
            return known

    def replans(self, id_: str, progress: float) -> int:
        """How often the motion at a part of a plan, 0..1, was led around an obstacle."""
        with self._lock:
            motion = self._running.get(id_)
            command = None if motion is None else self._known.get(motion.left(progress)[0])
            return 0 if command is None else command.replans

    def around(self, before: CommandChain | None = None) -> CommandChain | None:
        """Takes out the oldest chain that was stopped by an obstacle, if any is older than another one."""
        with self._lock:
            order = {id_: number for number, id_ in enumerate(self._known)}

            def place(chain: CommandChain) -> float:
                return order.get(chain.commands[0].id, math.inf)

            oldest = min(self._around, key=place, default=None)
            if oldest is None or (before is not None and place(before) < place(oldest)):
                return None
            self._around.remove(oldest)
            return oldest

    def fail(self, id_: str, at: float) -> None:
        """A motion that is not running goes nowhere: what was commanded until then, s, is void."""
        with self._lock:
            self._fail(_given_up_with(id_), at)

    def give_up(self, reason: str, at: float) -> None:
        """What was commanded until then, s, is void, for this reason."""
        with self._lock:
            self._fail(f'given up: {reason}', at)

    def forget(self) -> None:
        """The controller is gone and follows no motion."""
        with self._lock:
            self._give_up()
            self._given_up.clear()

    def _chain(self, ids: list[str], blocked: tuple[Trajectory, float] | None = None) -> CommandChain:
        commands = (self._known.get(id_) for id_ in ids)
        return CommandChain(tuple(one for one in commands if one is not None), blocked=blocked)

    def _fail(self, reason: str, at: float) -> None:
        self._failed_at, self._failed = max(at, self._failed_at), reason
        self._failures += 1
        self._give_up()

    def _forget(self, ids: Iterable[str]) -> None:
        for id_ in ids:
            self._known.pop(id_, None)

    def _give_up(self) -> None:
        for motion in self._running.values():
            self._forget(motion.ends)
        self._given_up |= self._running
        self._running.clear()
        self._stale.clear()


def _given_up_with(id_: str) -> str:
    return f'given up with motion {id_} before it, which did not reach its target'
