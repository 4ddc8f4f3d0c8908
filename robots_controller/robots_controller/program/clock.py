"""Clock: the time of a robot program, the machine's or a simulation's."""

import math
import threading
import time

# Python refuses to wait for centuries; a wait may end early, so a long one is a few of these.
LONGEST_WAIT = 3600.0  # s


class Clock:
    """What a robot program needs of time: here the machine's monotonic time; others override it.

    Everything a program waits for (time, the end of a motion, the end of a pause) goes through `wait`,
    so that a simulated clock can see when the program stands still and until when.
    """

    spell: float = math.inf
    """Instructions of a computing program after which it calls `computes`; infinite for never."""

    def now(self) -> float:
        """Time in seconds, from any start, never running backwards."""
        return time.monotonic()

    def wait(self, condition: threading.Condition, deadline: float | None) -> None:
        """Wait until the condition is notified or `now()` has reached the deadline; may return early.

        Args:
            condition: Held by the caller; released while waiting.
            deadline: s, on this clock; None waits for a notification alone.
        """
        if deadline is None:
            condition.wait()
        else:
            condition.wait(min(max(deadline - self.now(), 0.0), LONGEST_WAIT))

    def program_begins(self) -> None:
        """The program begins, in its thread; on a clock shared in turns it waits for its first turn."""

    def program_started(self) -> None:
        """The program's thread was started; the cell continues when the program waits."""

    def program_ended(self) -> None:
        """The program has ended and does not wait any longer."""

    def called(self) -> None:
        """The program calls a robot function; on a clock that stands while it computes, time may pass."""

    def computes(self) -> bool:
        """The program has computed for a spell; true where time has to pass for it to end."""
        return False

    def pass_period(self) -> None:
        """Let a period pass for a program that does not wait."""
