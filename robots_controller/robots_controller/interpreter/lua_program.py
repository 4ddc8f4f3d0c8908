"""LuaProgram: a robot program in Lua in a thread of its own (paper, section 4.1 and table 1).

The language is Lua 5.4; the reasons stand in `lua_sandbox`. Which functions a program has, stands in
`lua_functions.LUA_FUNCTIONS`.
"""

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_controller.defaults import ANALOG_SIZE, DIGITAL_SIZE
from robots_controller.interpreter.debugger import CallStack, Debugger, HoldReason, Step
from robots_controller.interpreter.lua_source import LuaSource, check_syntax, read_source
from robots_controller.interpreter.program_run import ProgramRun
from robots_controller.program.cell_port import CellPort
from robots_controller.program.files.cell_frames import FRAMES_FILE
from robots_controller.program.files.persistent_values import SUFFIX as VALUES_SUFFIX
from robots_controller.program.files.taught_points import SUFFIX
from robots_controller.program.motions.motion_command import OutputChange
from robots_controller.program.motions.motion_target import RobotView
from robots_controller.program.program_state import ProgramState
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.orientation import check_convention

LONGEST_END: Final = 5.0  # s


class LuaProgram(ProgramState):
    """A robot program and what it shares with the robot's side; every method is safe from any thread.

    The program commands a motion by setting the command state and `motion`, and waits; the robot's side
    moves the robot and calls `finish_motion`, which sets IDLE and lets the program continue.

    Args:
        num_axes: n.
        cell: The cell in which the program runs.
        digital_size: Number of digital inputs, and of digital outputs.
        analog_size: Number of analog inputs, and of analog outputs.
        io_labels: Names of inputs and outputs, see `IoImage`.
        orientation_convention: Order of the angles phi, one of `ORIENTATION_CONVENTIONS`.
        prismatic: (n,) which axes slide, so that their targets are metres; none by default.

    Raises:
        InvalidInputError: a size below 1, an unknown convention, or not one `prismatic` per axis.
    """

    def __init__(
        self,
        num_axes: int,
        cell: CellPort,
        *,
        digital_size: int = DIGITAL_SIZE,
        analog_size: int = ANALOG_SIZE,
        io_labels: Mapping[str, Sequence[str]] = MappingProxyType({}),
        orientation_convention: str = 'zyx',
        prismatic: Sequence[bool] = (),
    ) -> None:
        check_convention(orientation_convention)
        if prismatic and len(prismatic) != num_axes:
            raise InvalidInputError(f'prismatic has {len(prismatic)} values for {num_axes} axes')
        self._cell = cell
        super().__init__(
            num_axes,
            digital=digital_size,
            analog=analog_size,
            clock=self._cell.clock,
            labels=io_labels,
            prismatic=tuple(prismatic),
        )
        self._convention = orientation_convention
        self._hold_lock = threading.Lock()
        self._reported_hold = False
        self.debugger = Debugger()
        self.hold_reason: HoldReason = ''
        """Why the program is held: 'pause', 'breakpoint', 'step', 'entry', 'release'; '' if it is not."""
        self.call_stack = CallStack()
        """Where the held program is and what its variables are; empty while it runs."""
        self._enabled = True
        self.points_file: Path | None = None
        """Where taught points stand; beside the program by default."""
        self.frames_file: Path | None = None
        """Where tools and bases stand; beside the program by default."""
        self._source: LuaSource | None = None
        self._line_source: LuaSource | None = None
        self._thread: threading.Thread | None = None
        self.line = 0
        """Line of the last call of a robot function, or of the error; 0 before the first."""
        self.error: ProgramError | None = None
        """Why the last run failed."""
        self._failure = ''

    # -- the run ----------------------------------------------------------------------------------

    def open(self, path: Path | str) -> None:
        """Open a program; it replaces the one before and is checked, not run.

        Raises:
            ProgramError: a program runs; or the file cannot be read, or is not Lua: none is open then, so
                that nobody runs the one before in its place.
        """
        with self.condition:
            self._refuse_while_running('open another program')
        try:
            source = read_source(path)
            check_syntax(source)
        except RobotsError:
            self._replace(None)
            raise
        self._replace(source)

    def _replace(self, source: LuaSource | None) -> None:
        with self.condition:
            self._refuse_while_running('open another program')
            self._source, self._line_source = source, None
            self.line, self.error = 0, None
            self.set_run_state(RunState.OPENED if source else RunState.IDLE)

    def close(self) -> None:
        """Close the program; none is open then.

        Raises:
            ProgramError: no program is open, it runs, or the robot still moves.
        """
        with self.condition:
            self._source_at_rest('close')
            self._replace(None)

    def run(self, *, hold: bool = False) -> None:
        """Run the opened program from its start, in a parallel thread.

        Args:
            hold: Hold it before its first line.

        Raises:
            ProgramError: no program is open, one runs, or the robot still moves for an earlier one.
        """
        if not self.running and self._thread is not threading.current_thread():
            self.join(LONGEST_END)  # the run before may still report its end
        with self.condition:
            source = self._source_at_rest('run')
            self._line_source, self.line, self.error, self._failure = None, 0, None, ''
            self.debugger.step('in' if hold else None, entry=hold)
            self._set_hold_reason('')
            self.set_run_state(RunState.RUNNING)
            self._cell.started()
            self._thread = threading.Thread(
                target=self._run, args=(source,), name=f'lua {source.file}', daemon=True
            )
            self._thread.start()

    def fail(self, reason: str) -> bool:
        """Stop the program for good, as `stop`; it has failed, for this reason.

        Returns:
            True if it was running.
        """
        with self.condition:
            if not self.stopping:
                self._failure = reason
            return self.stop()

    def pause(self) -> bool:
        """Hold the program at its next statement, wait or motion, and the robot on its path.

        A program that is held because nobody holds run does not continue any more when somebody does.

        Returns:
            True if it was running, or held for that reason.
        """
        if self.hold_for('pause'):
            return True
        with self.condition:
            waiting = self.hold_reason == 'release'
            if waiting:
                self.hold_reason = 'pause'
        return waiting

    def resume(self) -> bool:
        """Let a held program continue.

        Returns:
            True if it was held.
        """
        return self._release(None)

    def set_enabled(self, *, enabled: bool) -> None:
        """Hold the program as long as a person does not hold run, and let it continue when one does."""
        self._enabled = enabled
        if not enabled:
            self.hold_for('release')
        elif self.hold_reason == 'release':
            self._release(None)

    def suspend(self) -> None:
        """Pause the program where a person had to hold run and need not any more: only `resume` ends that."""
        self._enabled = True
        self.pause()

    def step(self, step: Step = 'over') -> bool:
        """Let a held program continue for one step, see `Debugger.step`.

        Returns:
            True if it was held.
        """
        return self._release(step)

    def reset(self) -> None:
        """Set a program that has ended back to its start and forget its error; outputs stay.

        Raises:
            ProgramError: no program is open, it runs, or the robot still moves.
        """
        with self.condition:
            self._source_at_rest('reset')
            self._line_source, self.line, self.error = None, 0, None
            self.set_run_state(RunState.OPENED)

    def join(self, timeout: float | None = None) -> bool:
        """Wait until the program has ended and `CellPort.ended` has returned.

        Args:
            timeout: s of the wall's time; None waits for ever.

        Returns:
            True if it has ended.
        """
        thread = self._thread
        if thread is None:
            return True
        thread.join(timeout)
        return not thread.is_alive()

    @property
    def path(self) -> Path | None:
        """The opened program's path."""
        source = self._source
        return source.path if source else None

    @property
    def written(self) -> int:
        """When the text that was opened was written, ns since 1970; 0 for none."""
        source = self._source
        return source.written if source else 0

    @property
    def file(self) -> str:
        """The opened program's file name, '' for none."""
        source = self._source
        return source.file if source else ''

    @property
    def line_file(self) -> str:
        """The program or subprogram that `line` belongs to, '' for none."""
        source = self._line_source
        return source.file if source else self.file

    def switch_output(self, change: OutputChange) -> None:
        """Switch an output for a motion on its way (see `PathSwitch`); from any thread."""
        if self.set_output(change.kind, change.index, change.value):
            self._cell.output_changed(change)

    def source_line(self, number: int) -> str:
        """Text of a line of the program or subprogram that `line` belongs to, '' where there is none."""
        source = self._line_source or self._source
        return source.line(number) if source else ''

    # -- holding --------------------------------------------------------------------------------------

    def hold_for(self, reason: HoldReason) -> bool:
        """Hold the program, for a reason; False if it does not run."""
        if not self.change_run_state(RunState.RUNNING, RunState.PAUSED):
            return False
        self._set_hold_reason(reason)
        self.report_hold()
        return True

    def _release(self, step: Step | None) -> bool:
        with self.condition:
            if self.run_state is not RunState.PAUSED or not self._enabled:
                return False
            self.debugger.step(step)
            self._set_hold_reason('')
            released = self.change_run_state(RunState.PAUSED, RunState.RUNNING)
        self.report_hold()
        return released

    def _set_hold_reason(self, reason: HoldReason) -> None:
        self.hold_reason, self.call_stack = reason, CallStack()

    def report_hold(self) -> None:
        """Let the robot stand on its path, or continue, as the program wants it."""
        # One at a time: the state reported last is the present one.
        with self._hold_lock:
            held = self.robot_held
            if held != self._reported_hold:
                self._reported_hold = held
                self._cell.hold(held=held)

    def set_call_stack(self, stack: CallStack) -> None:
        """The program is held and looks like this; without frames it continues."""
        self.call_stack = stack
        self._cell.held_changed()

    # -- the program's thread -----------------------------------------------------------------------

    def _run(self, source: LuaSource) -> None:
        self.clock.program_begins()
        view = RobotView(
            self._convention,
            self.prismatic,
            self.points_file or source.path.with_suffix(SUFFIX),
            source.path.with_suffix(VALUES_SUFFIX),
            self.frames_file or source.path.with_name(FRAMES_FILE),
        )
        run = ProgramRun(source, self, self._cell, view)
        error: ProgramError | None = None
        try:
            error, stopped = run.run()
            error = self._end(run, error, stopped=stopped)
        finally:
            self._cell.ended(error)

    def _end(self, run: ProgramRun, error: ProgramError | None, *, stopped: bool) -> ProgramError | None:
        with self.condition:
            if stopped and error is None and self._failure:
                error = ProgramError(self._failure, file=self.line_file, line=self.line)
            self.error = error
            self._set_hold_reason('')
            if error is not None:
                if error.line:
                    self._line_source, self.line = run.source_of(error.file), error.line
                self.set_run_state(RunState.FAILED)
            else:
                self.set_run_state(RunState.STOPPED if stopped else RunState.FINISHED)
        if self.motions:  # what stopped the robot releases it too
            self._reported_hold = False
        else:
            self.report_hold()
        return error

    def set_line(self, source: LuaSource, line: int) -> None:
        """The program calls a robot function on this line, or is held before it."""
        self._line_source, self.line = source, line
        self._cell.line_reached(line)

    def _refuse_while_running(self, action: str) -> None:
        if self.running:
            state = 'stopping; wait until it has stopped' if self.stopping else 'running; stop it first'
            raise ProgramError(f'cannot {action}: {self.file} is {state}')

    def _source_at_rest(self, action: str) -> LuaSource:
        if self._source is None:
            raise ProgramError('no program is open; open one first')
        self._refuse_while_running(action)
        if self.motion is not None:
            raise ProgramError(f'cannot {action}: the robot still moves for line {self.motion.line}')
        return self._source
