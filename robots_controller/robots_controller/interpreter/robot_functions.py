"""RobotFunctions: serves the calls of one run of a robot program."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import replace

from robots_controller.degrees import in_degrees
from robots_controller.interpreter.debugger import HoldReason
from robots_controller.interpreter.functions.flow import Flow, Halt, Subprogram, printed_text
from robots_controller.interpreter.functions.guidance import Guidance
from robots_controller.interpreter.functions.interrupts import Interrupts
from robots_controller.interpreter.functions.kinematics import Kinematics
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.persistence import Persistence
from robots_controller.interpreter.functions.poses import Poses
from robots_controller.interpreter.functions.positions import Positions
from robots_controller.interpreter.functions.run_context import Handlers, RunContext, Waits
from robots_controller.interpreter.functions.search import Search
from robots_controller.interpreter.functions.settings import Settings
from robots_controller.interpreter.functions.signals import Signals
from robots_controller.interpreter.functions.tasks import Tasks
from robots_controller.interpreter.lua_arguments import Arguments, check_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, Waiting
from robots_controller.interpreter.lua_values import Sizes
from robots_controller.program.cell_port import CellPort
from robots_controller.program.guided_motion import GuidedMotion
from robots_controller.program.motion_target import MotionTarget, RobotView
from robots_controller.program.output_pulses import OutputPulses
from robots_controller.program.persistent_values import PersistentValues
from robots_controller.program.program_state import ProgramState
from robots_core.errors import RobotsError


class RobotFunctions:
    """The functions of `LUA_FUNCTIONS`, for one run.

    Args:
        state: What the program shares with its cell.
        cell: The cell.
        view: What the program sees of the robot.
        subprogram: Gives a subprogram's name and text.
        motion_ended: A motion that the program waited for has ended well.
        hold: Holds the program.
    """

    def __init__(
        self,
        state: ProgramState,
        cell: CellPort,
        view: RobotView,
        *,
        subprogram: Subprogram,
        motion_ended: Callable[[], None],
        hold: Callable[[HoldReason], bool],
    ) -> None:
        run = self.run = RunContext(state, cell, view, MotionTarget(view))
        self.pulses = OutputPulses(state, lambda index, value: run.set_output('digital', index, value))
        guided = GuidedMotion(state, view.position, cell.guide)
        motions = self.motions = Motions(run, guided, motion_ended)
        self._guided_motion = guided
        self._sizes = Sizes.of(state.num_axes, state.io, view.prismatic)
        values = PersistentValues(view.values_file, kept=not cell.simulated)
        self._handlers: Handlers = {
            **self._anywhere(run, motions, values, subprogram),
            **motions.handlers,
            **Search(run, motions, self._sizes, self._check).handlers,
            **Settings(run, motions).handlers,
            **Interrupts(run).handlers,
            **Guidance(run, motions, guided).handlers,
            **Halt(run, motions, hold).handlers,
            **Tasks(run, subprogram).handlers,
        }
        self._task_run = replace(run)
        self._task_handlers = self._anywhere(self._task_run, state.tasks, values, subprogram)

    def _anywhere(
        self, run: RunContext, waits: Waits, values: PersistentValues, subprogram: Subprogram
    ) -> Handlers:
        """What tasks may do too."""
        return {
            **Positions(run, waits).handlers,
            **Poses(run).handlers,
            **Kinematics(run).handlers,
            **Signals(run, waits, self.pulses).handlers,
            **Persistence(run, values).handlers,
            **Flow(run, waits, subprogram).handlers,
        }

    def serve(self, name: str, arguments: list[LuaArgument]) -> Waiting:
        """Serve one call from Lua.

        Raises:
            LuaCallError: wrong arguments, or a motion that failed.
            ProgramStopped: the program shall stop.
        """
        while self.run.state.needs_attention():
            yield
        if name == 'print':
            self.run.cell.printed(printed_text(arguments), self.run.line)
            return None
        return (yield from self._serve(self._handlers, name, arguments))

    def serve_task(self, name: str, line: int, arguments: list[LuaArgument]) -> Waiting:
        """Serve one call from the task that runs; arguments and errors as for `serve`."""
        yield from self.run.state.tasks.called()
        self._task_run.line, self._task_run.view = line, self.run.view
        if name == 'print':
            self.run.cell.printed(printed_text(arguments), line)
            return None
        if name not in self._task_handlers:
            raise LuaCallError(
                f'{name}: not in a task; the main program moves the robot and sets what holds for motions'
            )
        return (yield from self._serve(self._task_handlers, name, arguments))

    def _serve(self, handlers: Handlers, name: str, arguments: list[LuaArgument]) -> Waiting:
        checked = self._check(name, arguments)
        try:
            result = handlers[name](checked)
            if isinstance(result, Generator):
                result = yield from result
        except RobotsError as error:
            raise LuaCallError(f'{name}: {in_degrees(str(error))}') from error
        return result

    def _check(self, name: str, arguments: Sequence[LuaArgument]) -> Arguments:
        return check_arguments(LUA_FUNCTIONS[name], arguments, self._sizes)

    def finish(self) -> Waiting:
        """Wait until the robot stands and the last pulse is over."""
        yield from self.motions.standstill()
        yield from self.motions.waiting(lambda: not self.pulses.any)
        return None
