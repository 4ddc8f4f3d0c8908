"""LuaSandbox: one Lua interpreter that can be stopped at any time and reaches nothing but the robot.

Lua 5.4 of the five that lupa bundles: it is maintained, and each of its interpreters has a random
generator of its own, so that a program draws the same numbers in every run (5.3 shares the C library's).
Its count hook costs more than that of 5.3, which a program that moves a robot does not notice.

What Lua allows to run for ever without reaching a hook is wrapped: `pcall` and `xpcall` pass the stop on,
every coroutine gets the hook, finalizers (which run without hooks) are refused, patterns that might take
long are matched in Lua, and other library functions that loop in C (`table.move` and its like) are bounded.

No Python object is visible to the program. Numbers, booleans and strings go to Python, numbers and
booleans alone come back: a value that needs memory of Lua would, where none is left, leave Python by a C
`longjmp` that never gives back the interpreter lock.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, NoReturn

from lupa import lua54

from robots_controller.interpreter.lua_patterns import PATTERNS
from robots_controller.interpreter.lua_prelude import PRELUDE
from robots_controller.interpreter.lua_source import LuaSource
from robots_controller.interpreter.program_state import ProgramStopped

DEFAULT_MEMORY: Final = 100_000_000  # bytes
# An instruction may copy a string as long as the memory allows: few of them, so that a stop is quick.
HOOK_INSTRUCTIONS: Final = 200
# s of processor time between two looks at the stop flag: each takes the lock of the Python interpreter.
POLL_PERIOD: Final = 0.005
# So many steps in the worst case end in some tenths of a second.
MAX_PATTERN_STEPS: Final = 2e7
MAX_TABLE_STEPS: Final = 1_000_000
MAX_ARGUMENTS: Final = 100
# Bytes of a message per call from Lua, as whole numbers; the prelude counts on the same number.
MESSAGE_STEP: Final = 8

LuaValue = None | bool | int | float | bytes


@dataclass(frozen=True)
class LuaArgument:
    """One argument of a call from Lua.

    Attributes:
        type: Lua's name of its type.
        value: A boolean, number or string (bytes); None for every other type.
    """

    type: str
    value: LuaValue


class LuaCallError(Exception):
    """A call from Lua fails: the message becomes a Lua error."""


Call = Callable[[str, int, list[LuaArgument]], bool | float | None]
"""Serves a call: function name, line, arguments. Raises LuaCallError, or ProgramStopped."""


@dataclass(frozen=True)
class LuaFailure:
    """Why a program ended early.

    Attributes:
        stopped: It was stopped; there is nothing else to say.
        line: The program's line, 0 if none is known.
        reason: Lua's message without file and line.
        stack: The program's lines that led there, innermost first; '' if none is known.
    """

    stopped: bool
    line: int
    reason: str
    stack: str


class LuaSandbox:
    """A Lua interpreter for one run of one program. Create, use and drop it in one thread.

    Args:
        source: The program.
        functions: Names of the robot functions.
        call: Serves their calls.
        poll: Asked every few milliseconds of computing; it may wait. Raises ProgramStopped.
        memory: Highest use of memory, bytes.
    """

    def __init__(
        self,
        source: LuaSource,
        *,
        functions: tuple[str, ...],
        call: Call,
        poll: Callable[[], None],
        memory: int = DEFAULT_MEMORY,
    ) -> None:
        self._source = source
        self._functions = functions
        self._call = call
        self._poll = poll
        self._memory = memory
        self._message = b''
        self.host_error: BaseException | None = None
        """What a callback raised that is not the program's fault; it ends the run as a stop does."""

    def run(self) -> LuaFailure | None:
        """Run the program to its end.

        Returns:
            None at its end, or why it ended early.
        """
        runtime = _runtime(self._memory)
        run = runtime.execute(
            PRELUDE,
            self._source.text.encode(),
            self._source.chunk_name.encode(),
            self._serve,
            self._next_bytes,
            self._ask,
            HOOK_INSTRUCTIONS,
            POLL_PERIOD,
            MAX_PATTERN_STEPS,
            MAX_TABLE_STEPS,
            MAX_ARGUMENTS,
            PATTERNS,
            *(name.encode() for name in self._functions),
            name=b'=robots',
        )
        outcome = run()
        if outcome is None:
            return None
        stopped, line, reason, stack = outcome
        if stopped:
            return LuaFailure(True, 0, '', '')
        prefix_line, text = _split(self._source, reason.decode(errors='replace'))
        return LuaFailure(
            False, prefix_line or line, text or 'error without a message', stack.decode(errors='replace')
        )

    # Called from Lua: an exception would become a Lua value that the program can see, so none leaves.

    def _serve(self, name: bytes, line: int, *arguments: Any) -> tuple[int, bool | float | None]:
        try:
            pairs = zip(arguments[::2], arguments[1::2], strict=True)
            named = [LuaArgument(kind.decode(), value) for kind, value in pairs]
            return _DONE, self._call(name.decode(), line, named)
        except LuaCallError as error:
            self._message = str(error).encode(errors='replace')
            return _FAILED, len(self._message)
        except ProgramStopped:
            return _STOP, None
        except BaseException as error:  # noqa: BLE001  # the owner of the run hands it on
            self.host_error = error
            return _STOP, None

    def _next_bytes(self) -> tuple[int, ...]:
        step, self._message = self._message[:MESSAGE_STEP], self._message[MESSAGE_STEP:]
        return tuple(step)

    def _ask(self) -> bool:
        try:
            self._poll()
        except ProgramStopped:
            return True
        except BaseException as error:  # noqa: BLE001  # the owner of the run hands it on
            self.host_error = error
            return True
        return False


_DONE, _FAILED, _STOP = 0, 1, 2


def syntax_error(source: LuaSource, text: str) -> tuple[int, str] | None:
    """Compile `text` as if it were the program: None, or line and reason of the first syntax error."""
    problem = _runtime(DEFAULT_MEMORY).execute(
        b'local text, name = ... local chunk, problem = load(text, name, "t") return problem',
        text.encode(),
        b'=' + source.chunk_name.encode(),
    )
    return None if problem is None else _split(source, problem.decode(errors='replace'))


def _runtime(memory: int) -> Any:
    return lua54.LuaRuntime(
        encoding=None,
        register_eval=False,
        register_builtins=False,
        unpack_returned_tuples=True,
        attribute_filter=_no_attributes,
        max_memory=memory,
    )


def _no_attributes(_object: object, name: object, _setting: bool) -> NoReturn:  # noqa: FBT001  # lupa's
    raise AttributeError(name)


def _split(source: LuaSource, text: str) -> tuple[int, str]:
    prefix = f'{source.chunk_name}:'
    number, colon, reason = text.removeprefix(prefix).partition(':')
    if text.startswith(prefix) and colon and number.isdecimal():
        return int(number), reason.strip()
    return 0, text
