"""TurnClock: simulated time that a robot program and its cell share in turns."""

import math
import threading
from collections.abc import Callable
from typing import Final

from robots_controller.program.clock import Clock

NANOSECONDS: Final = 1_000_000_000
# A program that reads an input in a loop without waiting would let no time pass for the input to change.
CALLS_PER_PERIOD: Final = 200
# Counted, not timed, so that each run is the same; in a live cell they take less than a millisecond.
INSTRUCTIONS_PER_PERIOD: Final = 50_000
# Computing between two calls takes no time; a program that continues for longer waits in a loop for a change.
SPELLS_WITHOUT_TIME: Final = 20
# Passes for a program that calls functions again and again without waiting.
CALLS_PERIOD: Final = 0.004  # s


class TurnClock(Clock):
    """Time that stands still while the program computes, and passes while it waits (see `Clock`).

    The program's thread and the cell's take turns: while one works, the other one waits for it, so that
    neither the speed of the machine nor its scheduler has any influence.

    Args:
        stamp: Gives the time in ns.
    """

    spell: float = INSTRUCTIONS_PER_PERIOD

    def __init__(self, stamp: Callable[[], int]) -> None:
        self._stamp = stamp
        self.deadline = math.inf
        """Until when the waiting program waits, s; infinite for a change alone."""
        self._condition = threading.Condition()
        self._waits_in = self._condition
        self._program_has_turn = False
        self.waiting = False
        """The program waits; it neither computes nor has it ended."""
        self._ended = False
        self._cell_turn = threading.Semaphore(0)
        self._calls = 0
        self._calls_at = -1
        self._spells = 0
        self._computed_at = -1
        self.busy = False
        """The program that waits lets time pass alone, and could continue."""

    @property
    def deadline_stamp(self) -> float:
        """Time in whole nanoseconds at which the program's wait is over; infinite for never."""
        if self.deadline == math.inf:
            return math.inf
        stamp = math.ceil(self.deadline * NANOSECONDS - 1e-3)
        while stamp / NANOSECONDS < self.deadline:  # a nanosecond is finer than the rounding of late times
            stamp += 1
        return stamp

    # -- the program's thread ---------------------------------------------------------------------

    def now(self) -> float:
        """Time in seconds."""
        return self._stamp() / NANOSECONDS

    def wait(self, condition: threading.Condition, deadline: float | None) -> None:
        """Wait as `Clock.wait` says: the cell has the turn until it gives it back."""
        if self._ended:
            return
        # A wait whose rest is smaller than the rounding of the time would never end.
        shortest = (self._stamp() + 1) / NANOSECONDS
        self._wait_for_turn(condition, math.inf if deadline is None else max(deadline, shortest))

    def program_begins(self) -> None:
        """See `Clock`: it gets its turn at this instant, when what starts it has been done everywhere."""
        with self._condition:
            self._wait_for_turn(self._condition, self.now())

    def _wait_for_turn(self, condition: threading.Condition, deadline: float) -> None:
        self._waits_in, self.deadline, self.waiting = condition, deadline, True
        self._program_has_turn = False
        self._cell_turn.release()
        while not self._program_has_turn:
            condition.wait()
        self.waiting = False

    def called(self) -> None:
        """Let a period pass if the program calls functions without ever waiting."""
        if self._calls_at != self._stamp():
            self._calls, self._calls_at = 0, self._stamp()
        self._calls += 1
        if self._calls > CALLS_PER_PERIOD:
            self.pass_period()

    def computes(self) -> bool:
        """See `Clock`."""
        if self._computed_at != self._stamp():
            self._spells, self._computed_at = 0, self._stamp()
        self._spells += 1
        return self._spells > SPELLS_WITHOUT_TIME

    def pass_period(self) -> None:
        """See `Clock`."""
        end = self.now() + CALLS_PERIOD
        self.busy = True
        with self._condition:
            while self.now() < end and not self._ended:
                self.wait(self._condition, end)
        self.busy = False
        self._computed_at = self._stamp()

    def program_ended(self) -> None:
        """The program will not wait any more."""
        self._cell_turn.release()

    # -- the cell's thread ------------------------------------------------------------------------

    def program_started(self) -> None:
        """Wait until the program that was just started waits for its first turn."""
        self._ended = False
        self._cell_turn.acquire()

    def yield_to_program(self) -> None:
        """Let the waiting program work until it waits again or ends."""
        with self._waits_in:
            self._program_has_turn = True
            self._waits_in.notify_all()
        self._cell_turn.acquire()

    def end(self) -> None:
        """No time will pass any more: the program, which has to stop, must not wait for it."""
        self._ended = True
        if self.waiting:
            self.yield_to_program()
