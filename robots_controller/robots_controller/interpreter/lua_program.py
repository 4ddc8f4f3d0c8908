"""LuaProgram: a robot program in Lua in a thread of its own (paper, section 4.1 and table 1).

The language is Lua 5.4; the reasons stand in `lua_sandbox`. Which functions a program has, stands in
`lua_functions.LUA_FUNCTIONS`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_controller.interpreter.clock import Clock, WallClock
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS, ProgramEvents, RobotFunctions
from robots_controller.interpreter.lua_sandbox import DEFAULT_MEMORY, LuaFailure, LuaSandbox, syntax_error
from robots_controller.interpreter.lua_source import LuaSource, check_syntax, read_source
from robots_controller.interpreter.program_state import (
    MotionCommand,
    OutputChange,
    ProgramState,
    RunState,
)
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.pose import ORIENTATION_CONVENTIONS, Pose
from robots_core.validation import Array
from robots_planning.robot_command_state import RobotCommandState

DIGITAL_SIZE: Final = 32
ANALOG_SIZE: Final = 8


def _ignore(*_: object) -> None:
    pass


class LuaProgram:
    """A robot program and what it shares with the robot's side; every method is safe from any thread.

    The program commands a motion by setting the command state and `motion`, and waits; the robot's side
    moves the robot and calls `finish_motion`, which sets IDLE and lets the program go on.

    Args:
        num_axes: n.
        digital_size: Number of digital inputs, and of digital outputs.
        analog_size: Number of analog inputs, and of analog outputs.
        orientation_convention: Order of the angles phi, one of `ORIENTATION_CONVENTIONS`.
        prismatic: (n,) which axes slide, so that their targets are metres; none by default.
        clock: The time that `wait` takes; the wall's by default.
        on_command: A motion is commanded. A RobotsError that it raises fails the motion.
        on_output: An output changed.
        on_print: A printed text and the program's line.
        on_line: The program calls a robot function on another line than before.
        on_finished: The program ended: None, or why it failed. `run_state` tells a stop from the end.

        All callbacks are called from the program's thread.

    Raises:
        InvalidInputError: a size below 1, an unknown convention, or not one `prismatic` per axis.
    """

    def __init__(
        self,
        num_axes: int,
        *,
        digital_size: int = DIGITAL_SIZE,
        analog_size: int = ANALOG_SIZE,
        orientation_convention: str = 'zyx',
        prismatic: Sequence[bool] = (),
        clock: Clock | None = None,
        on_command: Callable[[MotionCommand], None] = _ignore,
        on_output: Callable[[OutputChange], None] = _ignore,
        on_print: Callable[[str, int], None] = _ignore,
        on_line: Callable[[int], None] = _ignore,
        on_finished: Callable[[ProgramError | None], None] = _ignore,
    ) -> None:
        if orientation_convention not in ORIENTATION_CONVENTIONS:
            raise InvalidInputError(
                f'unknown orientation convention {orientation_convention!r}; conventions are '
                f'{", ".join(ORIENTATION_CONVENTIONS)}'
            )
        if prismatic and len(prismatic) != num_axes:
            raise InvalidInputError(f'prismatic has {len(prismatic)} values for {num_axes} axes')
        self._state = ProgramState(
            num_axes, digital=digital_size, analog=analog_size, clock=clock or WallClock()
        )
        self._convention = orientation_convention
        self._prismatic = tuple(prismatic)
        self._events = ProgramEvents(on_command, on_output, on_print, self._set_line)
        self._on_line = on_line
        self._on_finished = on_finished
        self._source: LuaSource | None = None
        self._thread: threading.Thread | None = None
        self._line = 0
        self._error: ProgramError | None = None

    # -- the run ----------------------------------------------------------------------------------

    def open(self, path: Path | str) -> None:
        """Open a program; it replaces the one before and is checked, not run.

        Raises:
            ProgramError: a program runs, the file cannot be read, or it is not Lua; the one before stays.
        """
        source = read_source(path)
        check_syntax(source, lambda text: syntax_error(source, text))
        with self._state.condition:
            self._refuse_while_running('open another program')
            self._source, self._line, self._error = source, 0, None
            self._state.set_run_state(RunState.OPENED)

    def run(self) -> None:
        """Run the opened program from its start, in a parallel thread.

        Raises:
            ProgramError: no program is open, one runs, or the robot still moves for an earlier one.
        """
        with self._state.condition:
            source = self._source
            if source is None:
                raise ProgramError('no program is open; open one first')
            self._refuse_while_running('run')
            self._refuse_while_moving('run')
            self._line, self._error = 0, None
            self._state.set_run_state(RunState.RUNNING)
            self._thread = threading.Thread(
                target=self._run, args=(source,), name=f'lua {source.file}', daemon=True
            )
            self._thread.start()

    def stop(self) -> bool:
        """Stop the program for good, wherever it is; a commanded motion is the robot's side to stop.

        Returns:
            True if it was running. It ends a moment later: see `join`.
        """
        return self._state.stop()

    def pause(self) -> bool:
        """Hold the program at its next statement, wait or motion.

        Returns:
            True if it was running.
        """
        return self._state.change_run_state(RunState.RUNNING, RunState.PAUSED)

    def resume(self) -> bool:
        """Let a paused program go on.

        Returns:
            True if it was paused.
        """
        return self._state.change_run_state(RunState.PAUSED, RunState.RUNNING)

    def reset(self) -> None:
        """Set a program that has ended back to its start and forget its error; outputs stay.

        Raises:
            ProgramError: no program is open, it runs, or the robot still moves.
        """
        with self._state.condition:
            if self._source is None:
                raise ProgramError('no program is open; open one first')
            self._refuse_while_running('reset')
            self._refuse_while_moving('reset')
            self._line, self._error = 0, None
            self._state.set_run_state(RunState.OPENED)

    def join(self, timeout: float | None = None) -> bool:
        """Wait until the program has ended and `on_finished` has returned.

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
    def run_state(self) -> RunState:
        """What the program does."""
        return self._state.run_state

    @property
    def stopping(self) -> bool:
        """The program was told to stop."""
        return self._state.stopping

    @property
    def file(self) -> str:
        """The opened program's file name, '' for none."""
        source = self._source
        return source.file if source else ''

    @property
    def line(self) -> int:
        """Line of the last call of a robot function, or of the error; 0 before the first."""
        return self._line

    @property
    def error(self) -> ProgramError | None:
        """Why the last run failed."""
        return self._error

    def source_line(self, number: int) -> str:
        """Text of a line of the opened program, '' where there is none."""
        source = self._source
        return source.line(number) if source else ''

    # -- what the program shares ------------------------------------------------------------------

    @property
    def num_axes(self) -> int:
        """Number of axes n; it cannot change while the program runs."""
        return self._state.num_axes

    @num_axes.setter
    def num_axes(self, num_axes: int) -> None:
        if self._prismatic and num_axes != len(self._prismatic):
            raise InvalidInputError(f'prismatic names {len(self._prismatic)} axes, num_axes = {num_axes}')
        self._state.set_num_axes(num_axes)

    @property
    def command_state(self) -> RobotCommandState:
        """What the robot is commanded to do; setting IDLE ends the motion as `finish_motion` does."""
        return self._state.command_state

    @command_state.setter
    def command_state(self, state: RobotCommandState | str) -> None:
        self._state.set_command_state(state)

    @property
    def motion(self) -> MotionCommand | None:
        """The motion that is commanded and not finished."""
        return self._state.motion

    def finish_motion(self, error: RobotsError | None = None) -> None:
        """End the commanded motion: the robot stands at the target, or `error` says why not."""
        self._state.finish_motion(error)

    @property
    def reference_cartesian_position(self) -> Pose | None:
        """The last commanded pose of tool0 in the base frame; None before the first."""
        return self._state.reference_pose

    @property
    def digital_inputs(self) -> NDArray[np.bool_]:
        """Image of the digital inputs; set 0s and 1s for inputs 1..k, further inputs keep theirs."""
        return self._state.digital_inputs

    @digital_inputs.setter
    def digital_inputs(self, values: ArrayLike) -> None:
        self._state.set_digital_inputs(values)

    @property
    def analog_inputs(self) -> Array:
        """Image of the analog inputs; set numbers for inputs 1..k, further inputs keep theirs."""
        return self._state.analog_inputs

    @analog_inputs.setter
    def analog_inputs(self, values: ArrayLike) -> None:
        self._state.set_analog_inputs(values)

    @property
    def digital_outputs(self) -> NDArray[np.bool_]:
        """Image of the digital outputs; the first is output 1."""
        return self._state.digital_outputs

    @property
    def analog_outputs(self) -> Array:
        """Image of the analog outputs; the first is output 1."""
        return self._state.analog_outputs

    @property
    def overrides(self) -> Array:
        """Speed scale factor per axis, (n,), 0..1."""
        return self._state.overrides

    # -- the program's thread -----------------------------------------------------------------------

    def _run(self, source: LuaSource) -> None:
        functions = RobotFunctions(self._state, self._events, self._convention, self._prismatic)
        sandbox = LuaSandbox(
            source, functions=tuple(LUA_FUNCTIONS), call=functions.call, poll=self._state.hold
        )
        error: ProgramError | None
        try:
            failure = sandbox.run()
        except Exception as problem:  # noqa: BLE001  # the thread's end must be told in any case
            failure, sandbox.host_error = None, problem
        if sandbox.host_error is not None:
            error = ProgramError(
                f'internal error: {sandbox.host_error!r}', file=source.file, line=functions.line
            )
            error.__cause__ = sandbox.host_error
        else:
            error = _program_error(source, failure, functions)
        with self._state.condition:
            self._error = error
            if error is not None:
                self._line = error.line or self._line
                self._state.set_run_state(RunState.FAILED)
            else:
                self._state.set_run_state(RunState.STOPPED if failure else RunState.FINISHED)
        self._on_finished(error)

    def _set_line(self, line: int) -> None:
        self._line = line
        self._on_line(line)

    def _refuse_while_running(self, action: str) -> None:
        if self._state.running:
            raise ProgramError(f'cannot {action}: {self.file} is running; stop it first')

    def _refuse_while_moving(self, action: str) -> None:
        motion = self._state.motion
        if motion is not None:
            raise ProgramError(f'cannot {action}: the robot still moves for line {motion.line}')


def _program_error(
    source: LuaSource, failure: LuaFailure | None, functions: RobotFunctions
) -> ProgramError | None:
    if failure is None or failure.stopped:
        return None
    details: dict[str, str | float] = {}
    if functions.error is not None and failure.reason == functions.error_text:
        details |= functions.error.details
    details |= {'stack': failure.stack, 'source': source.line(failure.line)}
    for own in ('message', 'file', 'line'):
        details.pop(own, None)
    reason = failure.reason
    if reason == 'not enough memory':
        reason += f': the values of a program may take {DEFAULT_MEMORY // 1_000_000} MB'
    return ProgramError(reason, file=source.file, line=failure.line, **details)
