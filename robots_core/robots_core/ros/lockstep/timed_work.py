"""What a participant of a lock-step run does at given times."""

from collections.abc import Callable

from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS, PeriodicSchedule
from robots_core.periodic.periodic_thread import PeriodicThread
from robots_core.ros.lockstep.phases import NANOSECONDS, NEVER, START, Phase


class ScheduledLoop:
    """Calls `work(now)` at the multiples of a period that a simulated clock reaches.

    Args:
        work: Called with the time in s.
        period: ns.
        origin: Time of which the others are whole periods away, ns.
    """

    realtime = False
    idle_latency_kept = False

    def __init__(self, work: Callable[[float], None], *, period: int, origin: int = 0) -> None:
        self._work = work
        self._schedule = PeriodicSchedule(period, origin=origin, most_late=MAX_LATE_PERIODS)
        self.alive = True
        """It continues."""

    @property
    def missed(self) -> int:
        """Periods that the clock jumped over."""
        return self._schedule.missed

    def stop(self) -> None:
        """End it; called by its own work, that call is the last."""
        self.alive = False

    def run(self, now: int) -> None:
        """Do what is due at `now`, ns; past times in their order, as time goes from one to the next."""
        for time in self._schedule.due(now):
            if self.alive:
                self._work(time / NANOSECONDS)


Loop = PeriodicThread | ScheduledLoop
"""A node's loop: called periodically until it is stopped, on the wall clock or in simulated time."""


class LockstepLoop(ScheduledLoop):
    """A loop that has its turn in a phase, counted from `START`.

    Args:
        work: Called with the time in s.
        period: ns.
        phase: When in an instant.
        first: The first time is this one or the next multiple, ns.
        next_time: When the work has something to do, s: earlier turns are left out. Infinite for not until
            the participant has received something.
    """

    def __init__(
        self,
        work: Callable[[float], None],
        *,
        period: int,
        phase: Phase,
        first: int,
        next_time: Callable[[], float] | None = None,
    ) -> None:
        super().__init__(work, period=period, origin=START)
        self.phase, self._next_time = phase, next_time
        self._earliest = first
        self._schedule.begin(first)

    @property
    def due(self) -> int:
        """When it has its next turn, ns; `NEVER` for not at all, as of all work."""
        schedule = self._schedule
        assert schedule.next_time is not None
        if not self.alive:
            return NEVER
        if self._next_time is None:
            return schedule.next_time
        needed = instant(self._next_time())
        return NEVER if needed == NEVER else schedule.first(max(needed, self._earliest))

    def run(self, now: int) -> None:
        """As `ScheduledLoop.run`; turns that were left out are not made up."""
        if self._next_time is not None:
            self._schedule.begin(now)
        self.pass_over(now)
        super().run(now)

    def pass_over(self, now: int) -> None:
        """It has no further turn at `now`, ns: what it needs is done at the next multiple."""
        self._earliest = now + 1


class LockstepTimer:
    """A timer of a node with rclpy's methods, as far as they are about time.

    Args:
        period: ns.
        callback: Called without arguments.
        phase: When in an instant.
        now: The participant's time, ns.
        autostart: It runs from the beginning.
    """

    def __init__(
        self,
        period: int,
        callback: Callable[[], object],
        *,
        phase: Phase,
        now: Callable[[], int],
        autostart: bool = True,
    ) -> None:
        self.phase, self.callback = phase, callback
        self.timer_period_ns = period
        """Counts from the next `reset` or call on."""
        self._now = now
        self.due = NEVER
        if autostart:
            self.reset()

    def reset(self) -> None:
        """Start again: due one period from now."""
        self.due = self._now() + self.timer_period_ns

    def cancel(self) -> None:
        """Not due any more until `reset`."""
        self.due = NEVER

    def is_canceled(self) -> bool:
        """It was cancelled, or not started yet."""
        return self.due == NEVER

    def run(self, now: int) -> None:
        """Call back."""
        self.due = max(self.due + self.timer_period_ns, now + 1)
        self.callback()


class LockstepTurn:
    """Work that is done when it was asked for.

    Args:
        work: Called with the time in s.
        phase: When in an instant.
        asked: Called when the due time was changed.
    """

    def __init__(self, work: Callable[[float], None], *, phase: Phase, asked: Callable[[], None]) -> None:
        self.phase, self.due = phase, NEVER
        self._work, self._asked = work, asked

    def ask(self, time: float) -> None:
        """Ask for the turn at the first instant that is not before `time`, s; infinite cancels.

        Replaces what was asked for before. From any thread.
        """
        self.due = instant(time)
        self._asked()

    def run(self, now: int) -> None:
        """Do the work; it may ask for the next turn."""
        self.due = NEVER
        self._work(now / NANOSECONDS)


TimedWork = LockstepLoop | LockstepTimer | LockstepTurn
"""Something that is due at a time, in a phase."""


class Works:
    """All that a participant does at given times."""

    def __init__(self) -> None:
        self._works: list[TimedWork] = []

    def add(self, work: TimedWork) -> None:
        """Do this too."""
        self._works = [one for one in self._works if getattr(one, 'alive', True)] + [work]

    def due(self) -> list[int]:
        """When something is due next, ns, for each phase; `NEVER` for nothing."""
        due = [NEVER] * len(Phase)
        for work in self._works:
            due[work.phase] = min(due[work.phase], work.due)
        return due

    def run(self, phase: int, now: int) -> None:
        """Do what is due in a phase at `now`, ns."""
        works = [work for work in self._works if work.phase == phase and work.due <= now]
        for work in sorted(works, key=lambda work: work.due):
            if work.due <= now:  # not cancelled by one before it
                work.run(now)

    def pass_over(self, now: int) -> None:
        """No loop has a further turn at `now`, ns."""
        for work in self._works:
            if isinstance(work, LockstepLoop):
                work.pass_over(now)


def instant(time: float) -> int:
    """First nanosecond whose time in seconds is not before `time` (s); `NEVER` for infinity."""
    if time >= NEVER / NANOSECONDS:
        return NEVER
    nanoseconds = int(time * NANOSECONDS) - 1
    while nanoseconds / NANOSECONDS < time:  # a nanosecond is finer than the rounding of late times
        nanoseconds += 1
    return nanoseconds
