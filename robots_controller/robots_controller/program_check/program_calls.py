"""Calls of robot functions: their arguments as far as the text shows them, checked as a run checks them."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

from robots_controller.degrees import radians_hint
from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.functions.lua_function import LuaFunction
from robots_controller.interpreter.functions.search import checked_condition
from robots_controller.interpreter.lua_arguments import Arguments, check_arguments, wanted_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable
from robots_controller.interpreter.lua_tokens import Token
from robots_controller.interpreter.lua_values import UNKNOWN
from robots_controller.program_check.lua_calls import (
    closing,
    constant,
    is_table,
    lua_calls,
    split_values,
    table_fields,
)
from robots_planning.motion_kinds import KIND_OF_FUNCTION

FARTHEST: Final = 50.0  # m


def wrong_calls(tokens: Sequence[Token], sizes: Sizes, declared: set[str]) -> Iterator[tuple[int, str]]:
    """Line of the first problem of each call of a robot function, and what would be valid.

    What is computed is left to the run. `print` takes anything, and functions that the program declares too.
    """
    for call in lua_calls(tokens):
        function = LUA_FUNCTIONS.get(call.name.text)
        if function is None or function.name in declared or function.name == 'print':
            continue
        try:
            _check(function, call.arguments, sizes)
        except LuaCallError as error:
            yield call.name.line, str(error)


def _check(function: LuaFunction, arguments: Sequence[list[Token]], sizes: Sizes) -> None:
    given = [_value(argument) for argument in arguments]
    open_ended = bool(arguments) and not _single(arguments[-1])
    if function.name != 'moveUntil':
        _check_units(function, _checked(function, given, sizes, open_ended=open_ended), sizes)
        return
    motion = arguments[1][0].text if len(arguments) > 1 and len(arguments[1]) == 1 else ''
    if motion in KIND_OF_FUNCTION:
        given[1] = LuaArgument('string', motion.encode())
    search = _checked(function, given, sizes, open_ended=open_ended)
    if isinstance(search.values[0], LuaTable):
        checked_condition(search.values[0], sizes)
    if motion in KIND_OF_FUNCTION:
        _checked(LUA_FUNCTIONS[motion], [*search.more], sizes, open_ended=open_ended)


def _checked(function: LuaFunction, given: list[LuaArgument], sizes: Sizes, *, open_ended: bool) -> Arguments:
    """Check a call of which the text shows less than the run: more values at its end, tables by names."""
    wanted = wanted_arguments(function, sizes.num_axes, len(given))
    needed = sum(not argument.optional for _, argument in wanted)
    numbers = [argument for _, argument in wanted if argument.kind is kinds.NUMBER]
    as_table = (
        function.arguments
        and function.arguments[0].kind is kinds.NUMBER
        and given
        and (isinstance(given[0].value, LuaTable) or (given[0] is UNKNOWN and len(given) < needed))
    )
    most = len(wanted) if not as_table else 1 + len(wanted) - len(numbers)
    if function.options and given[-1:] == [UNKNOWN] and len(given) == most + 1:
        given, open_ended = given[:-1], False  # options
    if as_table and given[0] is UNKNOWN and not open_ended and len(given) <= most + bool(function.options):
        given = [LuaArgument('table', LuaTable((UNKNOWN,) * len(numbers), {})), *given[1:]]
    elif open_ended and not isinstance(given[0].value, LuaTable):
        given = [*given, *[UNKNOWN] * (needed - len(given))]
    return check_arguments(function, given, sizes)


def _value(tokens: Sequence[Token]) -> LuaArgument:
    if is_table(tokens):
        parts = [part for part in split_values(tokens[1:-1], ',;') if part]
        fields = table_fields(tokens)
        values = [part for part in parts if not (len(part) > 2 and part[1].text == '=')]
        if all(part[0].text != '[' for part in values) and all(map(_single, values[-1:])):
            named = {key: _value(value) for key, value in fields.items()}
            return LuaArgument('table', LuaTable(tuple(map(_value, values)), named))
    elif (number := constant(tokens)) is not None:
        return LuaArgument('number', number)
    elif len(tokens) == 1:
        (token,) = tokens
        match token.kind, token.text:
            case 'string', text:
                return LuaArgument('string', text.encode())
            case 'keyword', 'true' | 'false':
                return LuaArgument('boolean', token.text == 'true')
            case 'keyword', 'nil':
                return LuaArgument('nil', None)
    return UNKNOWN


def _single(argument: list[Token]) -> bool:
    """Whether an argument is one value for sure: a call or `...` at the end may give any number of them."""
    return (
        (len(argument) <= 1 and '...' not in {token.text for token in argument})
        or (argument[-1].text not in (')', '...') and argument[0].kind != 'keyword')
        or (argument[0].text == '(' and closing(argument, 0) == len(argument) - 1)
    )


def _check_units(function: LuaFunction, arguments: Arguments, sizes: Sizes) -> None:
    """Refuse lengths that are written in millimetres, and angles in radians.

    Raises:
        LuaCallError: a length is too large for any robot, or all angles of the call, of which one at least is
            not 0, look like radians.
    """
    lengths: list[tuple[str, float]] = []
    angles: list[float] = []
    wanted = wanted_arguments(function, sizes.num_axes, len(arguments.values))
    for (label, argument), value in zip(wanted, arguments.values, strict=False):
        if argument.kind is kinds.POSE and isinstance(value, list):
            lengths += [(f'{label}.{axis}', length) for axis, length in zip('xyz', value, strict=False)]
            angles += map(math.degrees, value[3:])
        elif isinstance(value, float) and argument.unit == 'm':
            lengths.append((label, value))
        elif isinstance(value, float) and argument.unit in ('deg', 'deg (m)'):
            angles.append(math.degrees(value))
    for label, length in lengths:
        if abs(length) >= FARTHEST:
            raise LuaCallError(
                f'{function.name}: {label} = {length:g} m; lengths are metres: {1e-3 * length:g}?'
            )
    if hint := radians_hint(angles):
        raise LuaCallError(f'{function.name}: these angles look like radians{hint}')
