"""ProgramRun: one run of a robot program, from its first line to its end."""

from collections.abc import Callable
from pathlib import PurePosixPath

from robots_controller.interpreter.debugger import CallStack, Debugger, HoldReason, call_stack
from robots_controller.interpreter.functions.run_context import RunContext
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_sandbox import (
    MAX_MEMORY,
    Attention,
    LuaArgument,
    LuaFailure,
    LuaSandbox,
    Waiting,
)
from robots_controller.interpreter.lua_source import LuaSource, check_syntax, read_source
from robots_controller.interpreter.robot_functions import RobotFunctions
from robots_controller.program.cell_port import CellPort
from robots_controller.program.motions.motion_target import RobotView
from robots_controller.program.program_state import ProgramState, RunState
from robots_core.errors import ProgramError


class ProgramRun:
    """Serves the sandbox: the robot's functions, subprograms, interrupts, and the debugger.

    The sandbox calls it from the program's thread; every such method may raise ProgramStopped.

    Args:
        source: The program.
        state: What the program shares with its cell.
        cell: The cell.
        view: The robot as the program reads it.
        debugger: Where to hold.
        hold: Holds the program, if it runs.
        report_hold: The robot shall stand on its path, or continue.
        held: The program is held and looks like this; without frames: it continues.
        line: The program or subprogram calls a robot function on another line, or is held before a line.
    """

    def __init__(
        self,
        source: LuaSource,
        state: ProgramState,
        cell: CellPort,
        view: RobotView,
        debugger: Debugger,
        *,
        hold: Callable[[HoldReason], bool],
        report_hold: Callable[[], None],
        held: Callable[[CallStack], None],
        line: Callable[[LuaSource, int], None],
    ) -> None:
        self._source = source
        self._state = state
        self._cell = cell
        self._debugger = debugger
        self._hold = hold
        self._report_hold = report_hold
        self._held = held
        self._report_line = line
        self._sources = {source.chunk_name: source}
        self._chunk = ''
        self._robot = RunContext(state, cell, view, self._subprogram, hold)
        self._functions = RobotFunctions(self._robot, motion_ended=self._motion_ended)

    def run(self) -> tuple[ProgramError | None, bool]:
        """Run the program to its end.

        Returns:
            Why it failed, if so, and whether it was stopped.
        """
        sandbox = LuaSandbox(
            self._source, functions=tuple(LUA_FUNCTIONS), host=self, spell=self._state.clock.spell
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
            if error is not None and self._state.motions:
                self._cell.abort()
        if error is not None or sandbox.stopped:
            self._cell.interrupted()
        return error, sandbox.stopped

    def source_of(self, file: str) -> LuaSource:
        """The program or subprogram with this name."""
        return next((one for one in self._sources.values() if one.file == file), self._source)

    # -- called by the sandbox --------------------------------------------------------------------

    def call(self, name: str, chunk: str, line: int, arguments: list[LuaArgument]) -> Waiting:
        """Serve a call of a robot function; '' at the program's end. Raises a LuaCallError."""
        if not name:
            return self._functions.finish()
        if self._state.tasks.current is not None:
            return self._functions.serve_task(name, line, arguments)
        self._set_line(chunk, line)
        self._state.clock.called()
        return self._functions.serve(name, arguments)

    def poll(self) -> Attention:
        """What interrupts the program while it computes; asked every few milliseconds."""
        attention = Attention.ATTEND if self._state.needs_attention() else Attention.NONE
        if self._debugger.tracing:
            attention |= Attention.TRACE
            if self._debugger.needs_depth:
                attention |= Attention.DEPTH
        return attention

    def computed(self, chunk: str, line: int) -> Attention:
        """Let time pass for a program that computes without ever waiting."""
        clock = self._state.clock
        if clock.computes():
            self._set_line(chunk, line)
            clock.pass_period()
        return self.poll()

    def at_line(self, chunk: str, line: int, depth: int) -> Attention:
        """Hold before a line that has a breakpoint or ends a step."""
        reason = self._debugger.at_line(chunk, line, depth)
        if reason:
            self._set_line(chunk, line)
            self._hold(reason)
        return self.poll()

    def attention(self, task: int) -> int | None:
        """What the program shall attend to: None for nothing, 0 to hold, n for handler n, -n for task n.

        Args:
            task: A task that begins; the negative of one that has ended; 0 for none.
        """
        state = self._state
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
            handler = self._functions.motions.begin_handler()
        self._report_hold()
        return handler

    def held(self, *records: str) -> Attention:
        """Hold the program, which looks like this (see `call_stack`)."""
        stack = call_stack(records)
        if stack.frames:
            frame = stack.frames[0]
            self._report_line(self._sources.get(frame.chunk, self._source), frame.line)
        self._held(stack)
        while True:
            self._state.hold()
            if self._state.run_state is not RunState.PAUSED:
                break
            self._robot.pulses.end()
        self._debugger.set_depth(stack.depth)
        self._held(CallStack())
        return self.poll()

    def handled(self, abort: bool) -> None:  # noqa: FBT001  # called from Lua
        """The handler of an input has ended; the motion under way continues, or not."""
        try:
            self._functions.motions.handled(abort=abort)
        finally:
            self._report_hold()

    # -- inside -----------------------------------------------------------------------------------

    def _set_line(self, chunk: str, line: int) -> None:
        if (chunk, line) != (self._chunk, self._robot.line):
            self._chunk, self._robot.line = chunk, line
            self._report_line(self._sources.get(chunk, self._source), line)

    def _motion_ended(self) -> None:
        reason = self._debugger.at_motion_end()
        if reason:
            self._hold(reason)

    def _subprogram(self, name: str) -> tuple[str, str]:
        source = find_subprogram(self._source, name)
        self._sources[source.chunk_name] = source
        return source.chunk_name, source.text

    def _error(self, failure: LuaFailure | None) -> ProgramError | None:
        if failure is None:
            return None
        functions, source = self._functions.motions, self._sources.get(failure.chunk, self._source)
        details: dict[str, str | float] = {}
        if functions.error is not None and failure.reason == functions.error_text:
            details |= functions.error.details
        details |= {'stack': failure.stack, 'source': source.line(failure.line)}
        for own in ('message', 'file', 'line'):
            details.pop(own, None)
        reason = failure.reason
        if reason == 'not enough memory':
            reason += f': the values of a program may take {MAX_MEMORY // 1_000_000} MB'
        return ProgramError(reason, file=source.file, line=failure.line, **details)


def find_subprogram(main: LuaSource, name: str) -> LuaSource:
    """Read a subprogram and check that it is Lua.

    Args:
        main: The main program; subprograms stand in its folder or below.
        name: Seen from there; '.lua' may be left out.

    Raises:
        ProgramError: it leads elsewhere, cannot be read, or is not Lua.
    """
    if '\0' in name:
        raise ProgramError(f'{name!r} has a null character; a subprogram is a file')
    path = PurePosixPath(name if name.endswith('.lua') else f'{name}.lua')
    folder = main.path.resolve().parent
    file = (folder / path).resolve()
    if path.is_absolute() or not file.is_relative_to(folder):
        raise ProgramError(
            f'{name!r} leads out of the folder of {main.file}; subprograms stand in it or below'
        )
    source = LuaSource(file, read_source(file).text, label=str(path))
    check_syntax(source)
    return source
