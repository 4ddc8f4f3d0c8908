"""Debugger: breakpoints, steps, and what a held program looks like."""

from __future__ import annotations

import json
import threading
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from robots_core.errors import InvalidInputError

Step = Literal['in', 'over', 'out', 'motion']
STEPS: Final[tuple[Step, ...]] = ('over', 'in', 'out', 'motion')
HoldReason = Literal['', 'entry', 'breakpoint', 'step', 'pause', 'release']


@dataclass(frozen=True)
class Variable:
    """A variable of a held program or an entry of a table: its value as a person reads it, Lua's type."""

    name: str
    value: str
    type: str
    entries: tuple[Variable, ...] = ()


@dataclass(frozen=True)
class Frame:
    """One level of a held program's call stack.

    Attributes:
        name: What runs there: 'in the program', "in function 'seam'".
        chunk: The program or subprogram.
        scopes: Variables by scope: Locals, Upvalues.
    """

    name: str
    chunk: str
    line: int
    scopes: dict[str, tuple[Variable, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class CallStack:
    """A held program.

    Attributes:
        frames: Innermost first.
        globals: The program's own global variables.
        depth: Number of all levels, those of Lua's own functions too; the frames are the innermost.
    """

    frames: tuple[Frame, ...] = ()
    globals: tuple[Variable, ...] = ()
    depth: int = 0

    def __str__(self) -> str:
        return '\n'.join(f'{frame.chunk}:{frame.line}: {frame.name}' for frame in self.frames)


def call_stack(records: Sequence[str]) -> CallStack:
    """The stack of the sandbox's records: four texts each, of frames, scopes and variables by depth."""
    frames: list[Frame] = []
    global_variables: tuple[Variable, ...] = ()
    depth = 0
    rows = deque(tuple(records[i : i + 4]) for i in range(0, len(records), 4))
    while rows:
        what, name, value, detail = rows.popleft()
        if what == 'frame':
            frames.append(Frame(name, value, int(detail)))
        elif what == 'depth':
            depth = int(detail)
        elif what == 'scope':
            scope = _variables(rows, 0)
            if name == 'Globals':
                global_variables = scope
            elif scope:
                frames[-1].scopes[name] = scope
    return CallStack(tuple(frames), global_variables, depth)


def _variables(rows: deque[tuple[str, ...]], depth: int) -> tuple[Variable, ...]:
    """Take the rows of the variables at a depth, with those of their entries."""
    found = []
    while rows and rows[0][0] == str(depth):
        _, name, value, kind = rows.popleft()
        found.append(Variable(name, value, kind, _variables(rows, depth + 1)))
    return tuple(found)


def call_stack_from_json(text: str) -> CallStack:
    """A call stack as lua_program_node gives it.

    Raises:
        InvalidInputError: it is none.
    """

    def variables(rows: Any) -> tuple[Variable, ...]:
        return tuple(Variable(**{**row, 'entries': variables(row['entries'])}) for row in rows)

    def frame(row: Any) -> Frame:
        scopes = {scope: variables(rows) for scope, rows in row['scopes'].items()}
        return Frame(**{**row, 'line': int(row['line']), 'scopes': scopes})

    try:
        data = json.loads(text)
        return CallStack(tuple(map(frame, data['frames'])), variables(data['globals']), int(data['depth']))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InvalidInputError(f'the call stack cannot be read: {error!r}') from None


class Debugger:
    """Where a program shall be held; safe from any thread.

    Breakpoints belong to file names and outlast a run; a step belongs to a run.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._breakpoints: dict[str, frozenset[int]] = {}
        self._step: Step | None = None
        self._entry = False
        self._depth: int | None = None

    def set_breakpoints(self, chunk: str, lines: Iterable[int]) -> None:
        """Hold at these lines of a program or subprogram, and no others of it."""
        with self._lock:
            self._breakpoints[chunk] = frozenset(lines)
            if not self._breakpoints[chunk]:
                del self._breakpoints[chunk]

    @property
    def breakpoints(self) -> dict[str, frozenset[int]]:
        """Lines by program or subprogram."""
        with self._lock:
            return dict(self._breakpoints)

    def step(self, step: Step | None, *, entry: bool = False) -> None:
        """Hold again after this step.

        Args:
            step: 'in' (the next line), 'over' (the next line not deeper), 'out' (the next line less deep),
                'motion' (the end of the next motion); None for none.
            entry: The step is the program's start.
        """
        with self._lock:
            self._step, self._entry, self._depth = step, entry, None

    @property
    def tracing(self) -> bool:
        """Lines are of interest."""
        with self._lock:
            return bool(self._breakpoints) or self._step in ('in', 'over', 'out')

    @property
    def needs_depth(self) -> bool:
        """So is the depth of the stack."""
        with self._lock:
            return self._step in ('over', 'out')

    def set_depth(self, depth: int) -> None:
        """How deep the stack is where a step begins."""
        with self._lock:
            if self._depth is None:
                self._depth = depth

    def at_line(self, chunk: str, line: int, depth: int) -> HoldReason:
        """Why to hold before this line, '' for not at all."""
        with self._lock:
            if self._step == 'in' or (
                self._depth is not None
                and depth
                and (
                    (self._step == 'over' and depth <= self._depth)
                    or (self._step == 'out' and depth < self._depth)
                )
            ):
                reason: HoldReason = 'entry' if self._entry else 'step'
            elif line in self._breakpoints.get(chunk, ()):
                reason = 'breakpoint'
            else:
                return ''
            self._step, self._depth, self._entry = None, None, False
            return reason

    def at_motion_end(self) -> HoldReason:
        """Why to hold after a motion, '' for not at all."""
        with self._lock:
            if self._step != 'motion':
                return ''
            self._step = None
            return 'step'


def breakpoints_by_file(texts: Iterable[str]) -> dict[str, set[int]]:
    """Lines by program or subprogram of texts like 'file.lua:12'; empty texts are none.

    Raises:
        InvalidInputError: a text without a line.
    """
    lines: dict[str, set[int]] = {}
    for text in filter(None, texts):
        file, colon, line = text.rpartition(':')
        if not (colon and file and line.isdecimal() and int(line) >= 1):
            raise InvalidInputError(f"{text!r} is no breakpoint; a breakpoint is 'file.lua:12'")
        lines.setdefault(file, set()).add(int(line))
    return lines
