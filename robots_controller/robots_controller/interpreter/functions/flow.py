"""Flow: the course of a program, its time and its texts."""

from typing import Any

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result, Waiting


class Flow(Family):
    """Calls subprograms, lets time pass, and prints."""

    @lua_function(
        Argument(
            'program', kinds.NAME, '', 'file of the subprogram, seen from the folder of the main program'
        ),
        returns=('what the subprogram returns', '...'),
        more=True,
    )
    def call(self, program: str, *_: Any) -> Result:
        """Runs another program as subprogram; it has the same globals, and further arguments as `...`."""
        name, text = self._run.subprogram(program)
        return f'{name}\n{text}'.encode()

    @lua_function(returns=('s, a number', 'number'))
    def getTime(self) -> Result:
        """Reads the time since the program's start; pauses count."""
        return self._run.state.clock.now() - self._run.start

    @lua_function(returns=('a function that returns s', 'fun(): number'))
    def timer(self) -> Result:
        """Starts a timer.

        `local elapsed = timer()`, and `elapsed()` is the time since then.
        """
        return self._run.state.clock.now() - self._run.start

    @lua_function(Argument('time', kinds.TIME, 's', 'how long, not counting pauses'))
    def wait(self, time: float) -> Waiting:
        """Waits."""
        yield from self._run.waits.standstill()
        yield from self._run.waits.waiting(lambda: False, time)
        return None

    @lua_function(Argument('string', kinds.TEXT, '', 'any values; several are separated by tabs'))
    def print(self, text: str) -> None:
        """Writes a line to the program's output."""
        self._run.cell.printed(text, self._run.line)


class MainFlow(Family):
    """Holds the program, and starts tasks, which the sandbox runs."""

    @lua_function(Argument('string', kinds.NAME, '', 'why, for the operator', optional=True))
    def halt(self, why: str | None) -> Waiting:
        """Holds the program until an operator resumes it.

        In simulated time it continues at once.
        """
        yield from self._run.waits.standstill()
        self._run.cell.printed(f'halt: {why}' if why else 'halt', self._run.line)
        if not self._run.cell.simulated:
            self._run.hold('pause')
            while self._run.state.needs_attention():
                yield
        return None

    @lua_function(
        Argument('program', kinds.NAME, '', 'file of the task, seen from the folder of the main program'),
        more=True,
    )
    def startTask(self, program: str, *_: Any) -> Result:
        """Runs a program beside this one, with the same globals and further arguments as `...`.

        It neither moves the robot nor changes motion settings.
        """
        name, text = self._run.subprogram(program)
        with self._run.state.condition:
            number = self._run.state.tasks.add()
        return f'{number}\n{name}\n{text}'.encode()
