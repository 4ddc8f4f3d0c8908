"""Persistence: values that are kept from one run of a program to the next."""

from typing import Final

from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result
from robots_controller.program.persistent_values import PersistentValues, Value

PERSISTENCE: Final = (
    LuaFunction(
        'setPersistent',
        (
            Argument('name', 'name', '', 'name of the value'),
            Argument(
                'value',
                'value',
                '',
                'number, string, boolean, list of numbers; nil for none',
                optional=True,
            ),
        ),
        'Keeps a value over runs, in a file beside the program; in simulated time until the end of the run.',
    ),
    LuaFunction(
        'getPersistent',
        (
            Argument('name', 'name', '', 'name of the value'),
            Argument('default', 'value', '', 'what is returned if there is none', optional=True),
        ),
        'Reads a value that was kept.',
        'the value, or `default`',
        'any',
    ),
)
"""Values over runs."""


class Persistence:
    """Keeps values.

    Args:
        run: The run.
        values: The values.
    """

    def __init__(self, run: RunContext, values: PersistentValues) -> None:
        self._run, self._values = run, values
        self.handlers: Handlers = {
            'setPersistent': lambda a: values.set(*a.values),
            'getPersistent': self._get,
        }

    def _get(self, arguments: Arguments) -> Result:
        name, default = arguments.values
        value: Value | None = self._values.get(name, default)
        if isinstance(value, str):
            return value.encode()
        return (value,) if isinstance(value, tuple) else value
