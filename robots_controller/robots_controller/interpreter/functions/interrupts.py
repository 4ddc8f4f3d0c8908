"""Interrupts: handlers that changes of inputs call."""

from collections.abc import Callable, Hashable
from typing import Any, Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.common_arguments import (
    ANALOG_INPUT,
    COMPARISON,
    DIGITAL_INPUT,
    SWITCH,
)
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result
from robots_controller.program.input_interrupts import DEFAULT_PRIORITY
from robots_controller.program.motions.motion_command import Kind
from robots_core.errors import ProgramError

_HANDLER: Final = (
    Argument('handler', kinds.FUNCTION, '', "called at the change; it may return 'abort'"),
    Argument(
        'priority', kinds.COUNT, '', f'1 is the most urgent, {DEFAULT_PRIORITY} the default', optional=True
    ),
)
_ITS_NUMBER: Final = ("the interrupt's number", 'integer')


class Interrupts(Family):
    """Sets handlers; the sandbox calls them."""

    @lua_function(DIGITAL_INPUT, SWITCH, *_HANDLER, returns=_ITS_NUMBER)
    def onDigitalInput(self, index: float, value: float, _: Any, priority: float | None) -> Result:
        """Lets a change of an input interrupt the program.

        The robot brakes on its path, `handler` runs, and the motion continues, or ends there if the handler
        returned 'abort'.
        """
        return self._add('digital', index, (index, value), lambda now: now == value, priority)

    @lua_function(ANALOG_INPUT, *COMPARISON, *_HANDLER, returns=_ITS_NUMBER)
    def onAnalogInput(
        self, index: float, comparison: str, value: float, _: Any, priority: float | None
    ) -> Result:
        """Lets an analog input interrupt the program when the comparison becomes true; see onDigitalInput."""
        compare = kinds.COMPARISONS[comparison]
        return self._add(
            'analog', index, (index, comparison, value), lambda now: compare(now, value), priority
        )

    @lua_function(Argument('number', kinds.COUNT, '', 'what onDigitalInput or onAnalogInput returned'))
    def removeInterrupt(self, number: float) -> None:
        """Removes an interrupt."""
        with self._run.state.condition:
            if not self._run.state.interrupts.remove(int(number)):
                raise ProgramError(f'there is no interrupt {int(number)}; it was removed or replaced')

    def _add(
        self,
        kind: Kind,
        index: float,
        what: Hashable,
        holds: Callable[[float], bool],
        priority: float | None,
    ) -> int:
        state = self._run.state
        channel = state.io.channel(kind, 'input', int(index))
        with state.condition:
            return state.interrupts.add(
                what, lambda: holds(state.io.value(channel)), int(priority or DEFAULT_PRIORITY)
            )
