"""Flow: the course of a program, its time and its texts."""

from typing import Any

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result, Waiting


class Flow(Family):
    """Calls subprograms, lets time pass, and prints."""

    @lua_function(
        'call',
        'Runs another program as subprogram; it has the same globals, and further arguments as `...`.',
        Argument(
            'program', kinds.NAME, '', 'file of the subprogram, seen from the folder of the main program'
        ),
        returns=('what the subprogram returns', '...'),
        more=True,
    )
    def _call(self, program: str, *_: Any) -> Result:
        name, text = self._run.subprogram(program)
        return f'{name}\n{text}'.encode()

    @lua_function(
        'getTime',
        "Reads the time since the program's start; pauses count.",
        returns=('s, a number', 'number'),
    )
    def _get_time(self) -> Result:
        return self._run.state.clock.now() - self._run.start

    @lua_function(
        'timer',
        'Starts a timer: `local elapsed = timer()`, and `elapsed()` is the time since then.',
        returns=('a function that returns s', 'fun(): number'),
    )
    def _timer(self) -> Result:
        return self._run.state.clock.now() - self._run.start

    @lua_function('wait', 'Waits.', Argument('time', kinds.TIME, 's', 'how long, not counting pauses'))
    def _wait(self, time: float) -> Waiting:
        yield from self._run.waits.standstill()
        yield from self._run.waits.waiting(lambda: False, time)
        return None

    @lua_function(
        'print',
        "Writes a line to the program's output.",
        Argument('string', kinds.TEXT, '', 'any values; several are separated by tabs'),
    )
    def _print(self, text: str) -> None:
        self._run.cell.printed(text, self._run.line)


class Halt(Family):
    """Holds the program."""

    @lua_function(
        'halt',
        'Holds the program until an operator resumes it; in simulated time it continues at once.',
        Argument('string', kinds.NAME, '', 'why, for the operator', optional=True),
    )
    def _halt(self, why: str | None) -> Waiting:
        yield from self._run.waits.standstill()
        self._run.cell.printed(f'halt: {why}' if why else 'halt', self._run.line)
        if not self._run.cell.simulated:
            self._run.hold('pause')
            while self._run.state.needs_attention():
                yield
        return None
