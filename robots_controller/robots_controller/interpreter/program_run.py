"""ProgramRun: one run of a robot program, from its first line to its end."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING

from robots_controller.degrees import for_program
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.debugger import CallStack, call_stack
from robots_controller.interpreter.functions.lua_function import Serve
from robots_controller.interpreter.functions.motions import Motions
from robots_controller.interpreter.functions.run_context import Family, RunContext
from robots_controller.interpreter.functions.search import Search
from robots_controller.interpreter.lua_arguments import Arguments, check_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS, MAIN_FAMILIES, TASK_FAMILIES
from robots_controller.interpreter.lua_sandbox import (
    MAX_MEMORY,
    Attention,
    LuaArgument,
    LuaCallError,
    LuaFailure,
    LuaSandbox,
    Waiting,
)
from robots_controller.interpreter.lua_source import LuaSource, find_subprogram
from robots_controller.program.cell_port import CellPort
from robots_controller.program.motions.motion_target import RobotView
from robots_controller.program.run_state import RunState
from robots_core.errors import ProgramError, RobotsError

if TYPE_CHECKING:
    from robots_controller.interpreter.lua_program import LuaProgram


class ProgramRun:
    """Serves the sandbox: the functions of `LUA_FUNCTIONS`, subprograms, interrupts, and the debugger.

    The sandbox calls it from the program's thread; every such method may raise ProgramStopped.
    """

    def __init__(self, source: LuaSource, program: LuaProgram, cell: CellPort, view: RobotView) -> None:
        self._source, self._program, self._cell = source, program, cell
        self._debugger = program.debugger
        self._sources = {source.chunk_name: source}
        self._chunk = ''
        self._robot = run = RunContext(program, cell, view, self._subprogram, program.hold_for)
        self._motions = run.waits = Motions(run, self._motion_ended)
        self._sizes = Sizes.of(program.num_axes, program.io, view.prismatic)
        search = Search(run, self._motions, self._sizes, self._check)
        own = (family(run) for family in (*MAIN_FAMILIES, *TASK_FAMILIES))
        self._handlers = _handlers(self._motions, search, *own)
        self._task_run = copy(run)
        self._task_run.waits = program.tasks
        self._task_handlers = _handlers(*(family(self._task_run) for family in TASK_FAMILIES))

    def run(self) -> tuple[ProgramError | None, bool]:
        """Run the program to its end.

        Returns:
            Why it failed, if so, and whether it was stopped.
        """
        sandbox = LuaSandbox(
            self._source, functions=tuple(LUA_FUNCTIONS), host=self, spell=self._program.clock.spell
        )
        try:
            failure = sandbox.run()
        except Exception as problem:  # noqa: BLE001  # the thread's end must be reported in any case
            failure, sandbox.host_error = None, problem
        error: ProgramError | None
        if sandbox.host_error is not None:
            error = ProgramError(
                f'internal error: {sandbox.host_error!r}',
                file=self._source.file,
                line=self._robot.line,
            )
            error.__cause__ = sandbox.host_error
        else:
            error = self._error(failure)
            self._robot.pulses.end(all_of_them=True)
            if error is not None and self._program.motions:
                self._cell.abort()
        if error is not None or sandbox.stopped:
            self._cell.interrupted()
        return error, sandbox.stopped

    def source_of(self, file: str) -> LuaSource:
        """The program or subprogram with this name."""
        return next((one for one in self._sources.values() if one.file == file), self._source)

    # -- called by the sandbox --------------------------------------------------------------------

    def call(self, name: str, chunk: str, line: int, arguments: list[LuaArgument]) -> Waiting:
        """Serve a call of a robot function; '' at the program's end.

        Raises:
            LuaCallError: wrong arguments, or a motion that failed.
        """
        if not name:
            return self._finish()
        if self._program.tasks.current is not None:
            return self._serve_task(name, line, arguments)
        self._set_line(chunk, line)
        self._program.clock.called()
        return self._serve_main(name, arguments)

    def poll(self) -> Attention:
        """What interrupts the program while it computes; asked every few milliseconds."""
        attention = Attention.ATTEND if self._program.needs_attention() else Attention.NONE
        if self._debugger.tracing:
            attention |= Attention.TRACE
            if self._debugger.needs_depth:
                attention |= Attention.DEPTH
        return attention

    def computed(self, chunk: str, line: int) -> Attention:
        """Let time pass for a program that computes without ever waiting."""
        clock = self._program.clock
        if clock.computes():
            self._set_line(chunk, line)
            clock.pass_period()
        return self.poll()

    def at_line(self, chunk: str, line: int, depth: int) -> Attention:
        """Hold before a line that has a breakpoint or ends a step."""
        reason = self._debugger.at_line(chunk, line, depth)
        if reason:
            self._set_line(chunk, line)
            self._program.hold_for(reason)
        return self.poll()

    def attention(self, task: int) -> int | None:
        """What the program shall attend to: None for nothing, 0 to hold, n for handler n, -n for task n.

        Args:
            task: A task that begins; the negative of one that has ended; 0 for none.
        """
        state = self._program
        state.tasks.current = None
        if task > 0:
            state.tasks.begin(task)
        else:
            state.tasks.end(-task)
        self._robot.pulses.end()
        with state.condition:
            if not state.needs_attention():
                return None
            if state.run_state is RunState.PAUSED:
                return 0
            if not state.interrupts.check():
                due = state.tasks.next()
                if due is None:
                    return None
                state.tasks.run(due)
                return -due
            handler = self._motions.begin_handler()
        self._program.report_hold()
        return handler

    def held(self, *records: str) -> Attention:
        """Hold the program, which looks like this (see `call_stack`)."""
        stack = call_stack(records)
        if stack.frames:
            frame = stack.frames[0]
            self._program.set_line(self._sources.get(frame.chunk, self._source), frame.line)
        self._program.set_call_stack(stack)
        while True:
            self._program.hold()
            if self._program.run_state is not RunState.PAUSED:
                break
            self._robot.pulses.end()
        self._debugger.set_depth(stack.depth)
        self._program.set_call_stack(CallStack())
        return self.poll()

    def handled(self, abort: bool) -> None:  # noqa: FBT001  # called from Lua
        """The handler of an input has ended; the motion under way continues, or not."""
        try:
            self._motions.handled(abort=abort)
        finally:
            self._program.report_hold()

    # -- inside -----------------------------------------------------------------------------------

    def _serve_main(self, name: str, arguments: list[LuaArgument]) -> Waiting:
        while self._program.needs_attention():
            yield
        return (yield from self._serve(self._handlers, name, arguments))

    def _serve_task(self, name: str, line: int, arguments: list[LuaArgument]) -> Waiting:
        yield from self._program.tasks.called()
        self._task_run.line, self._task_run.view = line, self._robot.view
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

    def _finish(self) -> Waiting:
        """Wait until the robot stands and the last pulse is over."""
        yield from self._motions.standstill()
        yield from self._motions.waiting(lambda: not self._robot.pulses.any)
        return None

    def _set_line(self, chunk: str, line: int) -> None:
        if (chunk, line) != (self._chunk, self._robot.line):
            self._chunk, self._robot.line = chunk, line
            self._program.set_line(self._sources.get(chunk, self._source), line)

    def _motion_ended(self) -> None:
        reason = self._debugger.at_motion_end()
        if reason:
            self._program.hold_for(reason)

    def _subprogram(self, name: str) -> tuple[str, str]:
        source = find_subprogram(self._source, name)
        self._sources[source.chunk_name] = source
        return source.chunk_name, source.text

    def _error(self, failure: LuaFailure | None) -> ProgramError | None:
        if failure is None:
            return None
        motions, source = self._motions, self._sources.get(failure.chunk, self._source)
        details: dict[str, str | float] = {}
        if motions.error is not None and failure.reason == motions.error_text:
            details |= motions.error.details
        details |= {'stack': failure.stack, 'source': source.line(failure.line)}
        for own in ('message', 'file', 'line'):
            details.pop(own, None)
        reason = failure.reason
        if reason == 'not enough memory':
            reason += f': the values of a program may take {MAX_MEMORY // 1_000_000} MB'
        return ProgramError(reason, file=source.file, line=failure.line, **details)


def _handlers(*families: Family) -> dict[str, Serve]:
    return {name: serve for family in families for name, serve in family.handlers.items()}
