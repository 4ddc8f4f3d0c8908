"""LockstepTurns: the turns of a robot program in a lock-step run."""

from robots_controller.program.turn_clock import TurnClock
from robots_core.ros.lockstep.participant import Participant
from robots_core.ros.lockstep.phases import NANOSECONDS, Phase


class LockstepTurns:
    """Lets the program work when its wait is over or something has changed, and the executor wait meanwhile.

    Args:
        participant: Of the node.
    """

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
