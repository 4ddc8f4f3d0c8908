"""Where a program is: what is told of it on `program_status`, and how often, in a cell and in simulation."""

from __future__ import annotations

from typing import Final

from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.program_state import RunState

# Lines of a loop that computes change thousands of times a second, and nobody reads so fast; the few lines
# between two waits all count.
RATE: Final = 50.0  # Hz
BURST: Final = 25.0


class TellingPace:
    """Lets `BURST` changes pass at once, and `RATE` of them in the long run."""

    def __init__(self) -> None:
        self._left, self._since = BURST, 0.0

    def passes(self, now: float) -> bool:
        """A change at this time (s) may be told; one that may not is told when the next one may."""
        self._left = min(BURST, self._left + RATE * (now - self._since))
        self._since = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


def told_place(program: LuaProgram, state: RunState, error: str) -> dict[str, object]:
    """State, file, line and its text, and error of a program."""
    line = program.line
    return {
        'state': state.value,
        'file': program.line_file,
        'line': line,
        'source': program.source_line(line),
        'error': error,
    }
