"""Persistence: values that are kept from one run of a program to the next."""

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result
from robots_controller.program.files.persistent_values import Value


class Persistence(Family):
    """Keeps values."""

    @lua_function(
        Argument('name', kinds.NAME, '', 'name of the value'),
        Argument(
            'value', kinds.VALUE, '', 'number, string, boolean, list of numbers; nil for none', optional=True
        ),
    )
    def setPersistent(self, name: str, value: Value | None) -> None:
        """Stores a value for later runs in a file beside the program.

        In simulated time it is stored until the run ends.
        """
        self._run.values.set(name, value)

    @lua_function(
        Argument('name', kinds.NAME, '', 'name of the value'),
        Argument('default', kinds.VALUE, '', 'what is returned if there is none', optional=True),
        returns=('the value, or `default`', 'any'),
    )
    def getPersistent(self, name: str, default: Value | None) -> Result:
        """Reads a stored value."""
        value = self._run.values.get(name, default)
        if isinstance(value, str):
            return value.encode()
        return (value,) if isinstance(value, tuple) else value
