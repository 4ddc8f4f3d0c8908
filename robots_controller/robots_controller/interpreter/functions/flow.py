"""Flow: the course of a program, its time and its texts."""

from collections.abc import Callable
from typing import Any, Final

from robots_controller.interpreter.debugger import HoldReason
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext, Waits
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import LuaArgument, Result, Waiting

FLOW: Final = (
    LuaFunction(
        'call',
        (
            Argument(
                'program', 'name', '', 'file of the subprogram, seen from the folder of the main program'
            ),
        ),
        'Runs another program as subprogram; it has the same globals, and further arguments as `...`.',
        'what the subprogram returns',
        '...',
        more=True,
    ),
    LuaFunction(
        'getTime', (), "Reads the time since the program's start; pauses count.", 's, a number', 'number'
    ),
    LuaFunction(
        'timer',
        (),
        'Starts a timer: `local elapsed = timer()`, and `elapsed()` is the time since then.',
        'a function that returns s',
        'fun(): number',
    ),
    LuaFunction(
        'halt',
        (Argument('string', 'name', '', 'why, for the operator', optional=True),),
        'Holds the program where the robot stands, until an operator lets it go on; in simulated time it '
        'goes on at once.',
    ),
    LuaFunction('wait', (Argument('time', 'time', 's', 'how long, not counting pauses'),), 'Waits.'),
    LuaFunction(
        'print',
        (Argument('string', 'text', '', 'any values; several are separated by tabs'),),
        "Writes a line to the program's output.",
    ),
)
"""The course of the program."""


Subprogram = Callable[[str], tuple[str, str]]
"""Gives the name and the text of a program."""


class Flow:
    """Calls subprograms, and lets time pass.

    Args:
        run: The run.
        waits: How its functions wait.
        subprogram: Gives a subprogram's name and text.
    """

    def __init__(self, run: RunContext, waits: Waits, subprogram: Subprogram) -> None:
        self._run, self._waits, self._subprogram = run, waits, subprogram
        self._start = run.state.clock.now()
        self.handlers: Handlers = {
            'call': self._call,
            'wait': self._wait,
            'getTime': self._get_time,
            'timer': self._get_time,
        }

    def _get_time(self, _: Arguments) -> Result:
        return self._run.state.clock.now() - self._start

    def _wait(self, arguments: Arguments) -> Waiting:
        yield from self._waits.standstill()
        yield from self._waits.waiting(lambda: False, arguments.values[0])
        return None

    def _call(self, arguments: Arguments) -> Result:
        name, text = self._subprogram(arguments.values[0])
        return f'{name}\n{text}'.encode()


class Halt:
    """Holds the program.

    Args:
        run: The run.
        waits: How its functions wait.
        hold: Holds it.
    """

    def __init__(self, run: RunContext, waits: Waits, hold: Callable[[HoldReason], bool]) -> None:
        self._run, self._waits, self._hold = run, waits, hold
        self.handlers: Handlers = {'halt': self._halt}

    def _halt(self, arguments: Arguments) -> Waiting:
        yield from self._waits.standstill()
        reason = f': {arguments.values[0]}' if arguments.values[0] else ''
        self._run.cell.printed(f'halt{reason}', self._run.line)
        if not self._run.cell.simulated:
            self._hold('pause')
            while self._run.state.needs_attention():
                yield
        return None


def printed_text(arguments: list[LuaArgument]) -> str:
    """The text of a call of `print`."""
    value: Any = arguments[0].value if arguments else b''
    return value.decode(errors='replace') if isinstance(value, bytes) else str(value)
