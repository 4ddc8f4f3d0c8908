"""Tasks: programs that run beside the one that moves the robot."""

from typing import Final

from robots_controller.interpreter.functions.flow import Subprogram
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result

TASKS: Final = (
    LuaFunction(
        'startTask',
        (Argument('program', 'name', '', 'file of the task, seen from the folder of the main program'),),
        'Runs a program beside this one, until it ends: with the same globals, and further arguments as '
        '`...`, for all that neither moves the robot nor sets what holds for motions.',
        more=True,
    ),
)
"""Background tasks."""


class Tasks:
    """Starts tasks; the sandbox runs them.

    Args:
        run: The run.
        subprogram: Gives a task's name and text.
    """

    def __init__(self, run: RunContext, subprogram: Subprogram) -> None:
        self._run, self._subprogram = run, subprogram
        self.handlers: Handlers = {'startTask': self._start}

    def _start(self, arguments: Arguments) -> Result:
        name, text = self._subprogram(arguments.values[0])
        with self._run.state.condition:
            number = self._run.state.tasks.add()
        return f'{number}\n{name}\n{text}'.encode()
