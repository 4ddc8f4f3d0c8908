"""A robot's side for tests of Lua programs: finishes motions from a thread of its own."""

from __future__ import annotations

import queue
import threading
import time
import weakref
from pathlib import Path
from typing import Any

from cell_double import CellDouble
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_core.errors import ProgramError, RobotsError

DEADLINE = 120.0  # s, for programs that should need milliseconds


class LuaHost:
    """Runs a program; every motion ends at once, or with the error given for its number (from 0).

    Options are functions of the cell's port, or options of the program.
    """

    def __init__(self, folder: Path, num_axes: int = 6, **options: Any) -> None:
        self.commands: list[MotionCommand] = []
        self.outputs: list[OutputChange] = []
        self.printed: list[str] = []
        self.lines: list[int] = []
        self.finished: list[ProgramError | None] = []
        self.errors: dict[int, RobotsError] = {}
        self.holding = False
        self.commanded = threading.Semaphore(0)
        self.spoken = threading.Semaphore(0)
        self._folder = folder
        self._robot: queue.SimpleQueue[int | None] = queue.SimpleQueue()
        functions = {name: options.pop(name) for name in tuple(options) if hasattr(CellDouble, name)}
        self.program = LuaProgram(
            num_axes,
            CellDouble(
                **{
                    'command': self._command,
                    'output_changed': self.outputs.append,
                    'printed': self._print,
                    'line_reached': self.lines.append,
                    'ended': self.finished.append,
                }
                | functions
            ),
            **options,
        )
        thread = threading.Thread(target=_move, args=(weakref.ref(self), self._robot), daemon=True)
        # No thread outlives its host.
        weakref.finalize(self, self._robot.put, None)
        thread.start()

    def _command(self, command: MotionCommand) -> None:
        self.commands.append(command)
        if not self.holding:
            self._robot.put(len(self.commands) - 1)
        self.commanded.release()

    def _print(self, text: str, _line: int) -> None:
        self.printed.append(text)
        self.spoken.release()

    def write(self, text: str | bytes, name: str = 'test.lua') -> Path:
        path = self._folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def start(self, text: str | bytes) -> None:
        self.program.open(self.write(text))
        self.program.run()

    def run(self, text: str | bytes) -> ProgramError | None:
        """Run to the end; the error, if it failed."""
        self.start(text)
        assert self.program.join(DEADLINE), 'the program did not end'
        return self.finished[-1]

    def fails(self, text: str | bytes) -> ProgramError:
        error = self.run(text)
        assert error is not None, 'the program did not fail'
        return error

    def refuses(self, call: str, message: str) -> None:
        """A call fails with its line, its function and a message, and nothing happens."""
        error = self.fails(f'\n\n{call}')
        assert str(error).startswith(f'test.lua:3: {call.partition("(")[0]}: ')
        assert message in str(error)
        assert self.commands == []
        assert self.outputs == []

    def wait_for_print(self) -> None:
        assert self.spoken.acquire(timeout=DEADLINE)

    def wait_for_command(self) -> None:
        assert self.commanded.acquire(timeout=DEADLINE)


def _move(host: weakref.ref[LuaHost], robot: queue.SimpleQueue[int | None]) -> None:
    while (number := robot.get()) is not None and (mine := host()) is not None:
        mine.program.finish_motion(mine.errors.get(number))
        del mine


def wait_until(condition: object) -> None:
    end = time.monotonic() + DEADLINE
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < end
        time.sleep(0.001)
