"""RobotFunctions: serves the calls of one run of a robot program."""

from collections.abc import Callable, Generator, Mapping, Sequence
from copy import copy

from robots_controller.degrees import for_program
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.functions.lua_function import Serve
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.run_context import RunContext
from robots_controller.interpreter.functions.search import Search
from robots_controller.interpreter.lua_arguments import Arguments, check_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS, MAIN_FAMILIES, TASK_FAMILIES
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, Waiting
from robots_core.errors import RobotsError


class RobotFunctions:
    """The functions of `LUA_FUNCTIONS`, for one run.

    Args:
        run: The run.
        motion_ended: A motion that the program waited for has ended well.
    """

    def __init__(self, run: RunContext, *, motion_ended: Callable[[], None]) -> None:
        self.run = run
        self.motions = run.waits = Motions(run, motion_ended)
        self._sizes = Sizes.of(run.state.num_axes, run.state.io, run.view.prismatic)
        families = (
            self.motions,
            Search(run, self.motions, self._sizes, self._check),
            *(family(run) for family in (*MAIN_FAMILIES, *TASK_FAMILIES)),
        )
        self._handlers = {name: serve for family in families for name, serve in family.handlers.items()}
        self._task_run = copy(run)
        self._task_run.waits = run.state.tasks
        task_families = [family(self._task_run) for family in TASK_FAMILIES]
        self._task_handlers = {
            name: serve for family in task_families for name, serve in family.handlers.items()
        }

    def serve(self, name: str, arguments: list[LuaArgument]) -> Waiting:
        """Serve one call from Lua.

        Raises:
            LuaCallError: wrong arguments, or a motion that failed.
            ProgramStopped: the program shall stop.
        """
        while self.run.state.needs_attention():
            yield
        return (yield from self._serve(self._handlers, name, arguments))

    def serve_task(self, name: str, line: int, arguments: list[LuaArgument]) -> Waiting:
        """Serve one call from the task that runs; arguments and errors as for `serve`."""
        yield from self.run.state.tasks.called()
        self._task_run.line, self._task_run.view = line, self.run.view
        if name not in self._task_handlers:
            raise LuaCallError(
                f'{name}: not in a task; the main program moves the robot and sets what holds for motions'
            )
        return (yield from self._serve(self._task_handlers, name, arguments))

    def _serve(self, handlers: Mapping[str, Serve], name: str, arguments: list[LuaArgument]) -> Waiting:
        checked = self._check(name, arguments)
        options = {} if checked.options is None else {'options': checked.options}
        try:
            result = handlers[name](*checked.values, *checked.more, **options)
            if isinstance(result, Generator):
                result = yield from result
        except RobotsError as error:
            raise LuaCallError(f'{name}: {for_program(error)}') from error
        return result

    def _check(self, name: str, arguments: Sequence[LuaArgument]) -> Arguments:
        return check_arguments(LUA_FUNCTIONS[name], arguments, self._sizes)

    def finish(self) -> Waiting:
        """Wait until the robot stands and the last pulse is over."""
        yield from self.motions.standstill()
        yield from self.motions.waiting(lambda: not self.run.pulses.any)
        return None
