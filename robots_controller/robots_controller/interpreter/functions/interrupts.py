"""Interrupts: handlers that changes of inputs call."""

from typing import Final

from robots_controller.interpreter.functions.common_arguments import (
    ANALOG_INPUT,
    COMPARISON,
    DIGITAL_INPUT,
    SWITCH,
)
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.functions.signals import COMPARE
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result
from robots_controller.program.input_interrupts import DEFAULT_PRIORITY
from robots_core.errors import ProgramError

_HANDLER: Final = Argument('handler', 'function', '', "called at the change; it may return 'abort'")
_PRIORITY: Final = Argument(
    'priority', 'count', '', f'1 is the most urgent, {DEFAULT_PRIORITY} the default', optional=True
)

INTERRUPTS: Final = (
    LuaFunction(
        'onDigitalInput',
        (DIGITAL_INPUT, SWITCH, _HANDLER, _PRIORITY),
        'Lets a change of an input interrupt the program: the robot brakes on its path, `handler` runs, the '
        "motion goes on, or ends there if it returned 'abort'.",
        "the interrupt's number",
        'integer',
    ),
    LuaFunction(
        'onAnalogInput',
        (
            ANALOG_INPUT,
            COMPARISON,
            Argument('value', 'number', '', 'what the input is compared with'),
            _HANDLER,
            _PRIORITY,
        ),
        "Lets an analog input interrupt the program when the comparison comes true, as 'onDigitalInput'.",
        "the interrupt's number",
        'integer',
    ),
    LuaFunction(
        'removeInterrupt',
        (Argument('number', 'count', '', 'what onDigitalInput or onAnalogInput returned'),),
        'Takes an interrupt away.',
    ),
)
"""Handlers of inputs."""


class Interrupts:
    """Sets handlers; the sandbox calls them.

    Args:
        run: The run.
    """

    def __init__(self, run: RunContext) -> None:
        self._run = run
        self.handlers: Handlers = {
            'onDigitalInput': self._on_digital_input,
            'onAnalogInput': self._on_analog_input,
            'removeInterrupt': self._remove,
        }

    def _on_digital_input(self, arguments: Arguments) -> Result:
        index, value, _, priority = arguments.values
        channel, state = self._run.state.io.channel('digital', 'input', int(index)), self._run.state
        with state.condition:
            return state.interrupts.add(
                (index, value), lambda: state.io.value(channel) == value, int(priority or DEFAULT_PRIORITY)
            )

    def _on_analog_input(self, arguments: Arguments) -> Result:
        index, comparison, value, _, priority = arguments.values
        channel, state = self._run.state.io.channel('analog', 'input', int(index)), self._run.state
        compare = COMPARE[comparison]
        with state.condition:
            return state.interrupts.add(
                (index, comparison, value),
                lambda: compare(state.io.value(channel), value),
                int(priority or DEFAULT_PRIORITY),
            )

    def _remove(self, arguments: Arguments) -> None:
        number = int(arguments.values[0])
        with self._run.state.condition:
            if not self._run.state.interrupts.remove(number):
                raise ProgramError(f'there is no interrupt {number}; it was removed or replaced')
