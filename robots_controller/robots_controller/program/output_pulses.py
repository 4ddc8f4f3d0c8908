"""OutputPulses: outputs of a program that switch off by themselves."""

from collections.abc import Callable

from robots_controller.program.program_state import ProgramState


class OutputPulses:
    """The digital outputs whose pulses are not over yet.

    Args:
        state: Its clock times the pulses, its alarm wakes the program at the end of the next one.
        switch: Sets a digital output.
    """

    def __init__(self, state: ProgramState, switch: Callable[[int, float], None]) -> None:
        self._state = state
        self._switch = switch
        self._ends: dict[int, float] = {}

    @property
    def any(self) -> bool:
        """Some pulse is not over."""
        return bool(self._ends)

    def start(self, index: int, duration: float) -> None:
        """Switch an output on, for so many s; a pulse that it has ends with this one."""
        self._switch(index, 1.0)
        self._ends[index] = self._state.clock.now() + duration
        self._set_alarm()

    def end(self, *, all_of_them: bool = False) -> None:
        """Switch off the outputs whose pulse is over."""
        now = self._state.clock.now()
        for index, end in list(self._ends.items()):
            if all_of_them or end <= now:
                del self._ends[index]
                self._switch(index, 0.0)
        self._set_alarm()

    def _set_alarm(self) -> None:
        self._state.set_alarm(min(self._ends.values(), default=None))
