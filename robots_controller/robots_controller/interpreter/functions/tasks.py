"""Tasks: programs that run beside the one that moves the robot."""

from typing import Any

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument, lua_function
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result


class Tasks(Family):
    """Starts tasks; the sandbox runs them."""

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
