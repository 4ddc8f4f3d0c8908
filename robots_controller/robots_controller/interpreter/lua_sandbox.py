"""LuaSandbox: one Lua interpreter that can be stopped at any time and reaches nothing but the robot.

Lua 5.4 of the five that lupa bundles: it is maintained, and each of its interpreters has a random
generator of its own, so that a program draws the same numbers in every run (5.3 shares the C library's).
Its count hook costs more than that of 5.3, which a program that moves a robot does not notice.

What Lua allows to run for ever without reaching a hook is wrapped: `pcall` and `xpcall` pass the stop on,
every coroutine gets the hook, finalizers (which run without hooks) are refused, patterns that might take
long are matched in Lua, and other library functions that loop in C (`table.move` and its like) are bounded.

No Python object is visible to the program. Numbers, booleans and strings go to Python, numbers and
booleans alone come back: a value that needs memory of Lua would, where none is left, leave Python by a C
`longjmp` that never gives back the interpreter lock. Texts and lists come back as a few numbers at a time.

A call that must wait does so in Python. Whenever the program is paused or an input interrupts it meanwhile,
the call comes back to Lua, which looks around for the debugger or runs the handler, and asks again.
"""

from __future__ import annotations

import itertools
import math
import struct
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from enum import IntFlag
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Final, NoReturn

from lupa import lua54

from robots_controller.interpreter.syntax_remedies import with_remedy
from robots_controller.program.run_state import ProgramStopped

if TYPE_CHECKING:
    from robots_controller.interpreter.lua_source import LuaSource
    from robots_controller.interpreter.program_run import ProgramRun

MAX_MEMORY: Final = 100_000_000  # bytes
# An instruction may copy a string as long as the memory allows: few of them, so that a stop is quick.
HOOK_INSTRUCTIONS: Final = 200
# s of processor time between two checks of the stop flag: each takes the lock of the Python interpreter.
POLL_PERIOD: Final = 0.005
# So many steps in the worst case end in some tenths of a second.
MAX_PATTERN_STEPS: Final = 2e7
MAX_TABLE_STEPS: Final = 1_000_000
MAX_ARGUMENTS: Final = 100
# Values per call from Lua: what a C function of Lua has room for without asking.
VALUES_STEP: Final = 16


def _chunk(name: str) -> bytes:
    return (files('robots_controller.interpreter.lua_side') / f'{name}.lua').read_bytes()


PARTS: Final = ('stopping', 'snapshot', 'texts', 'calls', 'own_functions', 'library', 'run')
PRELUDE: Final = b''.join(map(_chunk, PARTS))
"""Builds the program's globals and runs the program in them: what a part declares, those behind it use."""
PATTERNS: Final = _chunk('patterns')
"""Pattern matching that can be stopped anywhere."""

LuaScalar = None | bool | int | float | bytes


@dataclass(frozen=True)
class LuaTable:
    """A table that came as argument: its entries 1, 2, ..., and those with names."""

    values: tuple[LuaArgument, ...]
    fields: dict[str, LuaArgument]


@dataclass(frozen=True)
class LuaArgument:
    """One argument of a call from Lua.

    Attributes:
        type: Lua's name of its type.
        value: A boolean, number, string (bytes) or table; None for every other type.
    """

    type: str
    value: LuaScalar | LuaTable


class LuaCallError(Exception):
    """A call from Lua fails: the message becomes a Lua error."""


class PoseValues(tuple[float, ...]):
    """The six numbers of a pose, which become a pose in the program."""

    __slots__ = ()


Lists = tuple[tuple[float, ...], ...]
Result = bool | float | bytes | Lists | None
"""What a call gives back: nothing, a value, a text, or lists of numbers, which become tables."""

Waiting = Generator[None, None, Result]
"""A call on its way: it yields where the program must attend to something, and returns its result."""


class Attention(IntFlag):
    """What interrupts the program at its next instruction."""

    NONE = 0
    STOP = 1
    ATTEND = 2
    TRACE = 4  # report every line
    DEPTH = 8  # and how deep the stack is


@dataclass(frozen=True)
class LuaFailure:
    """Why a program failed.

    Attributes:
        chunk: The program or subprogram.
        line: Its line, 0 if none is known.
        reason: Lua's message without file and line.
        stack: The program's lines that led there, innermost first; '' if none is known.
    """

    chunk: str
    line: int
    reason: str
    stack: str


class LuaSandbox:
    """A Lua interpreter for one run of one program. Create, use and drop it in one thread.

    Args:
        functions: Names of the robot functions.
        host: Serves their calls.
        spell: Instructions between two calls of `computed`.
    """

    def __init__(
        self,
        source: LuaSource,
        *,
        functions: tuple[str, ...],
        host: ProgramRun,
        spell: float = math.inf,
    ) -> None:
        self._source = source
        self._functions = functions
        self._host = host
        self._spell = spell
        self._values: tuple[int | float, ...] = ()
        self._waiting: dict[int, Waiting] = {}
        self._tokens = itertools.count(1)
        self.stopped = False
        """The program was stopped, or a callback has failed."""
        self.host_error: BaseException | None = None
        """What a callback raised that is not the program's fault; it ends the run as a stop does."""

    def run(self) -> LuaFailure | None:
        """Run the program to its end.

        Returns:
            Why it failed; None at its end, or where it was stopped.
        """
        runtime, host = _runtime(), self._host
        callbacks = (
            self._serve,
            self._again,
            self._answered(lambda token: self._waiting.pop(token).close()),
            self._next_values,
            self._answered(host.poll),
            self._answered(host.computed),
            self._answered(host.at_line),
            self._attention,
            self._answered(host.held),
            self._answered(host.handled),
        )
        run = runtime.execute(
            _compiled(PRELUDE),
            self._source.text.encode(),
            self._source.chunk_name.encode(),
            lambda: callbacks,
            HOOK_INSTRUCTIONS,
            POLL_PERIOD,
            self._spell,
            MAX_PATTERN_STEPS,
            MAX_TABLE_STEPS,
            MAX_ARGUMENTS,
            _compiled(PATTERNS),
            *(name.encode() for name in self._functions),
        )
        try:
            outcome = run()
        except lua54.LuaError:
            # A stop may come between the program's end and the end of its supervision.
            if not self.stopped:
                raise
            return None
        finally:
            for waiting in self._waiting.values():
                waiting.close()
        if outcome is None:
            return None
        chunk, line, reason, stack = outcome
        line, text = _located(chunk.decode(), line, reason.decode(errors='replace'))
        return LuaFailure(chunk.decode(), line, with_remedy(text), stack.decode(errors='replace'))

    # Called from Lua: an exception would become a Lua value that the program can see, so none leaves.

    def _serve(self, name: bytes, chunk: bytes, line: int, *items: Any) -> tuple[int, Any, int]:
        token, rest = next(self._tokens), iter(items)
        try:
            arguments = [_argument(kind, rest) for kind in rest]
            self._waiting[token] = self._host.call(name.decode(), chunk.decode(), line, arguments)
        except BaseException as error:  # noqa: BLE001  # distinguished there
            return self._failed(error)
        return self._again(token)

    def _again(self, token: int) -> tuple[int, Any, int]:
        try:
            next(self._waiting[token])
        except StopIteration as end:
            del self._waiting[token]
            return self._answer(end.value)
        except BaseException as error:  # noqa: BLE001  # distinguished there
            del self._waiting[token]
            return self._failed(error)
        return _ATTEND, 0, token

    def _answer(self, result: Result) -> tuple[int, Any, int]:
        if isinstance(result, bytes):
            self._put_text(result)
            return _TEXT, len(result), 0
        if isinstance(result, tuple):
            parts = ((-6 if isinstance(part, PoseValues) else len(part), *part) for part in result)
            self._values = tuple(itertools.chain.from_iterable(parts))
            return _LISTS, len(self._values), 0
        return (_NOTHING, 0, 0) if result is None else (_DONE, result, 0)

    def _failed(self, error: BaseException) -> tuple[int, Any, int]:
        if isinstance(error, LuaCallError):
            message = str(error).encode(errors='replace')
            self._put_text(message)
            return _FAILED, len(message), 0
        self.stopped = True
        if not isinstance(error, ProgramStopped):
            self.host_error = error
        return _STOP, 0, 0

    def _put_text(self, text: bytes) -> None:
        count = -(-len(text) // 8)
        self._values = struct.unpack(f'<{count}q', text.ljust(8 * count, b'\0'))

    def _next_values(self) -> tuple[int | float, ...]:
        step, self._values = self._values[:VALUES_STEP], self._values[VALUES_STEP:]
        return step

    def _answered(self, ask: Callable[..., int | None]) -> Callable[..., int]:
        """A function as Lua calls it: texts come as bytes, and the answer is attention."""

        def answer(*arguments: Any) -> int:
            try:
                texts = (a.decode(errors='replace') if isinstance(a, bytes) else a for a in arguments)
                return int(ask(*texts) or Attention.NONE)
            except BaseException as error:  # noqa: BLE001  # distinguished there
                return self._stop(error)

        return answer

    def _attention(self, task: int) -> tuple[int, int]:
        try:
            wanted = self._host.attention(task)
        except BaseException as error:  # noqa: BLE001  # distinguished there
            return self._stop(error), 0
        if wanted is None:
            return 0, 0
        if wanted == 0:
            return 3, 0
        return (2, wanted) if wanted > 0 else (4, -wanted)

    def _stop(self, error: BaseException) -> int:
        self._failed(error)
        return int(Attention.STOP)


_DONE, _FAILED, _STOP, _LISTS, _ATTEND, _TEXT, _NOTHING = range(7)


def _argument(kind: bytes, items: Iterator[Any]) -> LuaArgument:
    value = next(items)
    name = kind.decode()
    if name == 'table':
        values = tuple(_argument(next(items), items) for _ in range(value))
        fields = {}
        for _ in range(next(items)):
            key = next(items).decode(errors='replace')
            fields[key] = _argument(next(items), items)
        return LuaArgument(name, LuaTable(values, fields))
    return LuaArgument(name, value if name in ('number', 'string', 'boolean') else None)


def syntax_error(chunk: str, text: str) -> tuple[int, str] | None:
    """Compile a text under the name of a program: None, or line and reason of the first syntax error."""
    problem = _runtime().execute(
        b'local text, name = ... local chunk, problem = load(text, name, "t") return problem',
        text.encode(),
        b'=' + chunk.encode(),
    )
    return None if problem is None else _located(chunk, 0, problem.decode(errors='replace'))


def lua_globals() -> frozenset[str]:
    """Names of all globals of Lua, those too that the sandbox withholds from programs."""
    return frozenset(name.decode() for name in _runtime().globals() if name != b'python')  # lupa's


@cache
def _compiled(chunk: bytes) -> bytes:
    """A chunk of the sandbox as code of Lua, which loads in a seventh of the time of its text."""
    code: bytes = _runtime().execute(b'return string.dump(load(..., "=robots", "t"))', chunk)
    return code


def _runtime() -> Any:
    return lua54.LuaRuntime(
        encoding=None,
        register_eval=False,
        register_builtins=False,
        unpack_returned_tuples=True,
        attribute_filter=_no_attributes,
        max_memory=MAX_MEMORY,
    )


def _no_attributes(_object: object, name: object, _setting: bool) -> NoReturn:  # noqa: FBT001  # lupa's
    raise AttributeError(name)


def _located(chunk: str, line: int, text: str) -> tuple[int, str]:
    # Lua's own words begin with their place; it is more exact than the frame that was found.
    prefix = f'{chunk}:'
    number, colon, reason = text.removeprefix(prefix).partition(':')
    if text.startswith(prefix) and colon and number.isdecimal():
        return int(number), reason.strip() or 'error without a message'
    return line, text or 'error without a message'
