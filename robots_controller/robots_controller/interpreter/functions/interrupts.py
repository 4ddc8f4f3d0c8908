"""Interrupts: handlers that changes of inputs call."""

from __future__ import annotations

from typing import Final

from robots_controller.interpreter.functions.common_arguments import DIGITAL_INPUT, SWITCH
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result

INTERRUPTS: Final = (
    LuaFunction(
        'onDigitalInput',
        (
            DIGITAL_INPUT,
            SWITCH,
            Argument('handler', 'function', '', "called at the change; it may return 'abort'"),
        ),
        'Lets a change of an input interrupt the program: the robot brakes on its path, `handler` runs, the '
        "motion goes on, or ends there if it returned 'abort'.",
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
        self.handlers: Handlers = {'onDigitalInput': self._on_digital_input}

    def _on_digital_input(self, arguments: Arguments) -> Result:
        index, value, _ = arguments.values
        with self._run.state.condition:
            return self._run.state.interrupts.add(int(index), bool(value), self._run.state.digital_inputs)
