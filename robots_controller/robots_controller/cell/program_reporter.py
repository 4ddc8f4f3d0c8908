"""ProgramReporter: reports where a program is, what it does and which motion was sent last."""

import threading
from collections.abc import Callable
from typing import Final

from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.clock import Clock
from robots_controller.program.run_state import RunState
from robots_core.status import Level, Status

# Lines of a loop that computes change thousands of times a second, faster than anyone reads; the few lines
# between two waits are all reported.
RATE: Final = 50.0  # Hz
BURST: Final = 25.0

Publish = Callable[[RunState, Status], None]


class ProgramReporter:
    """Reports at once, or, where lines change faster than `RATE`, the newest with the next report.

    Safe from any thread.

    Args:
        program: The program.
        clock: Limits the rate.
        publish: Takes the run state, and the status: the error, if any, and the place and motion by name.
    """

    def __init__(self, program: LuaProgram, clock: Clock, publish: Publish) -> None:
        self.open_error = ''
        """Why the program could not be opened, or ''."""
        self.due = False
        """A change has not been reported."""
        self._program, self._clock, self._publish = program, clock, publish
        self._lock = threading.Lock()
        self._left, self._since = BURST, 0.0
        self._motion: dict[str, object] = {}

    def line_changed(self) -> None:
        """The program is on another line."""
        self.due = True
        self.report_in_time()

    def motion_sent(self, id_: str, file: str, line: int) -> None:
        """A motion was sent.

        The program may be far ahead of the motions that it blends: the report names their lines.
        """
        self._motion = {'motion': id_, 'motion_file': file, 'motion_line': line}
        self.report()

    def report_in_time(self) -> None:
        """Report a change, unless too many were reported just now."""
        if not self.due:
            return
        now = self._clock.now()
        self._left = min(BURST, self._left + RATE * (now - self._since))
        self._since = now
        if self._left >= 1.0:
            self._left -= 1.0
            self.report()

    def report_if_due(self) -> None:
        """Report a change that has not been reported."""
        if self.due:
            self.report()

    def report(self) -> None:
        """Report everything now."""
        with self._lock:
            self.due = False
            program = self._program
            state, line = program.run_state, program.line
            error = str(program.error or self.open_error)
            values: dict[str, object] = {
                'state': state.value,
                'run': program.runs,
                'file': program.line_file,
                'line': line,
                'source': program.source_line(line),
                'error': error,
            }
            if program.hold_reason:
                values |= {'hold': program.hold_reason, 'stack': program.call_stack}
            text = error or f'{program.file or "no program"}: {state}'
            level = Level.ERROR if error else Level.OK
            self._publish(state, Status('program', text, level, values | self._motion))
