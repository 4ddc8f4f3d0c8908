"""Agenda: whose turn is next, by what the participants have reported."""

from dataclasses import dataclass
from typing import Final

from robots_core.errors import RobotsError
from robots_core.ros.lockstep.phases import NEVER, START, Phase
from robots_core.ros.lockstep.protocol import OVER
from robots_core.ros.lockstep.traffic import Traffic

# A participant that requests another turn in every turn would let no time pass.
MOST_TURNS: Final = 10_000


class LockstepError(RobotsError):
    """A lock-step run cannot continue; the message names the participant."""

    code = 'R404'
    remedy = (
        'See the log of the node that the message names; `docs/how_to/lockstep.md` lists what a '
        'lock-step run needs.'
    )


@dataclass(frozen=True)
class Turn:
    """What is due next.

    Attributes:
        time: ns.
        phase: Of the instant, or `OVER`.
        participants: Those that have something to do.
    """

    time: int
    phase: int
    participants: tuple[str, ...]


class Agenda:
    """Goes from instant to instant and from phase to phase, past those in which nothing is due.

    A phase is over when its turn was given, but planners and programs have turns until none has anything to
    do. Those for which something becomes due in a phase that is over have a turn `OVER` at the end of the
    instant, in which they report when they do it; what has no time of its own waits for the next instant.
    """

    def __init__(self) -> None:
        self.time = START
        """The present instant, ns."""
        self._next = Phase.ENVIRONMENT
        self._due: dict[str, tuple[int, ...]] = {}
        self._turns = 0
        self._over = False

    @property
    def place(self) -> tuple[int, int]:
        """The present instant, ns, and the next phase of it."""
        return self.time, self._next

    def resume(self, time: int, phase: int) -> None:
        """Continue at the place of another agenda."""
        if time != self.time:
            self._turns = 0
        self.time, self._next, self._over = time, Phase(phase), False

    @property
    def empty(self) -> bool:
        """Nothing will ever be due, unless something comes."""
        return all(time == NEVER for due in self._due.values() for time in due)

    def set_due(self, participant: str, due: tuple[int, ...]) -> None:
        """When a participant has something to do next, ns, for each phase; `NEVER` for nothing."""
        self._due[participant] = due

    def next_turn(self, *, advance: bool = True) -> Turn | None:
        """The next turn; None if nothing is due.

        Args:
            advance: Time may advance; otherwise only the present instant counts.

        Raises:
            LockstepError: time does not advance, a participant requests turn after turn.
        """
        turn = self._at_this_instant()
        if turn is not None:
            self._turns += 1
            if self._turns > MOST_TURNS:
                raise LockstepError(
                    f'{", ".join(turn.participants)} asked for {MOST_TURNS} turns at '
                    f'{1e-9 * turn.time:.9f} s, time cannot advance'
                )
            return turn
        if not advance or self.empty:
            return None
        overdue = tuple(name for name, times in self._due.items() if min(times) <= self.time)
        if overdue and not self._over:
            self._over = True
            return Turn(self.time, OVER, overdue)
        after = min((t for due in self._due.values() for t in due if t > self.time), default=NEVER)
        self.time = self.time + 1 if after == NEVER else after
        self._next, self._turns, self._over = Phase.ENVIRONMENT, 0, False
        return self.next_turn()

    def _at_this_instant(self) -> Turn | None:
        for phase in range(self._next, len(Phase)):
            due = tuple(name for name, times in self._due.items() if times[phase] <= self.time)
            if due:
                self._next = Phase(min(phase + 1, Phase.PLANNING))
                return Turn(self.time, Phase(phase), due)
        return None


class Reports:
    """What the participants have reported: what is due, what is on its way, and who works on."""

    def __init__(self) -> None:
        self.agenda, self.traffic = Agenda(), Traffic()
        self.busy: set[str] = set()
        """Participants whose work continues."""

    def read(self, participant: str, busy: int, *numbers: int) -> None:
        """Read a report from its third number on; see `REPORT`."""
        phases = len(Phase)
        self.agenda.set_due(participant, numbers[:phases])
        for place in range(phases, len(numbers), 2):
            self.traffic.count(participant, numbers[place], numbers[place + 1])
        if busy:
            self.busy.add(participant)
        else:
            self.busy.discard(participant)

    @property
    def quiet(self) -> bool:
        """Everything sent was handled, and nobody works on."""
        return not self.busy and self.traffic.quiet
