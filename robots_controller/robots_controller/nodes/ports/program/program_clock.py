"""A program's time: of a node that follows the wall clock or `/clock`, and in turns of a lock-step run."""

import threading

from robots_controller.program.clock import Clock
from robots_controller.program.turn_clock import TurnClock
from robots_core.ros.lockstep.participant import Participant
from robots_core.ros.lockstep.phases import NANOSECONDS, Phase
from robots_core.ros.running.clocks import on_clock_set
from robots_core.ros.timed_node import TimedNode


class ProgramClock(Clock):
    """See `Clock`. In simulated time a wait checks the clock whenever that is set."""

    def __init__(self, node: TimedNode) -> None:
        self._node = node
        self._waits_in: threading.Condition | None = None
        if node.simulated_time:
            self._jumps = on_clock_set(node.get_clock(), self._wake)

    def now(self) -> float:
        """See `Clock`."""
        return self._node.now()

    def wait(self, condition: threading.Condition, deadline: float | None) -> None:
        """See `Clock`."""
        self._waits_in = condition
        if deadline is None or not self._node.simulated_time:
            super().wait(condition, deadline)
        elif self.now() < deadline:
            condition.wait()  # until something changes, or the clock is set

    def _wake(self) -> None:
        condition = self._waits_in
        if condition is not None:
            with condition:
                condition.notify_all()


class LockstepTurns:
    """Lets the program work when its wait is over or something has changed; the executor waits meanwhile."""

    def __init__(self, participant: Participant) -> None:
        self._participant = participant
        self.clock = TurnClock(lambda: participant.time)
        """The program's time."""
        self._turn = participant.create_turn(self._give, phase=Phase.PROGRAM)

    def changed(self) -> None:
        """The waiting program may continue: it gets a turn at this instant."""
        if self.clock.waiting:
            self._turn.ask(self._participant.time / NANOSECONDS)

    def begun(self) -> None:
        """The program has begun and may wait already."""
        if self.clock.waiting:
            self._turn.ask(self.clock.deadline)

    def _give(self, _now: float) -> None:
        if self.clock.waiting:
            self.clock.yield_to_program()
            self.begun()
