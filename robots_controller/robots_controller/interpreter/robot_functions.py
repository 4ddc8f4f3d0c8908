"""RobotFunctions: serves the calls of one run of a robot program."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence

from robots_controller.degrees import in_degrees
from robots_controller.interpreter.debugger import HoldReason
from robots_controller.interpreter.functions.flow import Flow, printed_text
from robots_controller.interpreter.functions.guidance import Guidance
from robots_controller.interpreter.functions.interrupts import Interrupts
from robots_controller.interpreter.functions.kinematics import Kinematics
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.poses import Poses
from robots_controller.interpreter.functions.positions import Positions
from robots_controller.interpreter.functions.run_context import Handlers, RunContext
from robots_controller.interpreter.functions.search import Search
from robots_controller.interpreter.functions.settings import Settings
from robots_controller.interpreter.functions.signals import Signals
from robots_controller.interpreter.lua_arguments import Arguments, check_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, Waiting
from robots_controller.interpreter.lua_values import Sizes
from robots_controller.program.cell_port import CellPort
from robots_controller.program.guided_motion import GuidedMotion
from robots_controller.program.motion_target import MotionTarget, RobotView
from robots_controller.program.output_pulses import OutputPulses
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
        subprogram: Callable[[str], tuple[str, str]],
        motion_ended: Callable[[], None],
        hold: Callable[[HoldReason], bool],
    ) -> None:
        run = self.run = RunContext(state, cell, view, MotionTarget(view))
        self.pulses = OutputPulses(state, lambda index, value: run.set_output('digital', index, value))
        guided = GuidedMotion(state, view.position, cell.guide)
        motions = self.motions = Motions(run, guided, motion_ended)
        self._guided_motion = guided
        self._sizes = Sizes.of(state.num_axes, state.io, view.prismatic)
        self._handlers: Handlers = {
            **motions.handlers,
            **Settings(run, motions).handlers,
            **Positions(run, motions).handlers,
            **Poses(run).handlers,
            **Kinematics(run).handlers,
            **Signals(run, motions, self.pulses).handlers,
            **Interrupts(run).handlers,
            **Guidance(run, motions, guided).handlers,
            **Flow(run, motions, subprogram, hold).handlers,
            **Search(run, motions, self._sizes, self._check).handlers,
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
        checked = self._check(name, arguments)
        try:
            result = self._handlers[name](checked)
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
