"""Calls of robot functions with arguments or options that are not valid."""

from collections.abc import Iterator, Sequence

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.search import wrong_condition
from robots_controller.interpreter.lua_arguments import wanted_arguments
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_tokens import Token
from robots_controller.interpreter.lua_values import valid_text
from robots_controller.interpreter.motion_options import option_arguments, unknown_option, wrong_switch
from robots_controller.program_check.lua_calls import (
    closing,
    is_table,
    lua_calls,
    split_values,
    table_fields,
)
from robots_planning.motion_kinds import KIND_OF_FUNCTION


def wrong_calls(tokens: Sequence[Token], sizes: Sizes, declared: set[str]) -> Iterator[tuple[int, str]]:
    """Line and problem of each call of a robot function that cannot be served."""
    for call in lua_calls(tokens):
        function = LUA_FUNCTIONS.get(call.name.text)
        if function is None or function.name in declared or function.name == 'print':
            continue
        for reason in _problems_of_call(function, call.arguments, sizes):
            yield call.name.line, f'{function.name}: {reason}'


def _problems_of_call(function: LuaFunction, arguments: Sequence[list[Token]], sizes: Sizes) -> Iterator[str]:
    arguments = list(arguments)
    if function.options and len(arguments) > 1 and _is_options(arguments[-1]):
        yield from _problems_of_options(function, arguments.pop(), sizes)
    if function.name == 'moveUntil' and len(arguments) > 1:
        yield from _problems_of_search(arguments, sizes)
        return
    first = function.arguments[0] if function.arguments else None
    if first is not None and first.kind is kinds.NUMBER and arguments and is_table(arguments[0]):
        arguments = [*split_values(arguments[0][1:-1], ',;'), *arguments[1:]]
    open_ended = bool(arguments) and not _single(arguments[-1])
    # A name alone may be a table with all values.
    behind = sum(argument.kind is not kinds.NUMBER for argument in function.arguments)
    if (
        first is not None
        and first.kind is kinds.NUMBER
        and 1 <= len(arguments) <= 1 + behind
        and arguments[0][0].kind == 'name'
    ):
        return
    wanted = wanted_arguments(function, sizes.num_axes, len(arguments))
    needed = sum(not argument.optional for _, argument in wanted)
    most = len(wanted) if not function.more else len(arguments)
    if function.options and arguments and arguments[-1] and arguments[-1][0].kind == 'name':
        most += 1  # a table of options by its name
    if len(arguments) > most or (len(arguments) < needed and not open_ended):
        what = 'joint angles' if first is not None and first.per_axis else 'arguments'
        count = f'{needed}' if needed == len(wanted) else f'{needed} to {len(wanted)}'
        robot = f' for {sizes.num_axes} axes' if what == 'joint angles' else f': {function.signature}'
        yield f'{len(arguments)} {what}, needed are {count}{robot}'
        return
    for (label, argument), given in zip(wanted, arguments, strict=False):
        yield from _problem_of_value(label, argument, given, sizes)


def _problems_of_search(arguments: Sequence[list[Token]], sizes: Sizes) -> Iterator[str]:
    condition, motion, *more = arguments
    if is_table(condition) and (problem := wrong_condition(table_fields(condition))) is not None:
        yield problem
    if len(motion) == 1 and motion[0].text in KIND_OF_FUNCTION:
        yield from _problems_of_call(LUA_FUNCTIONS[motion[0].text], more, sizes)


def _is_options(argument: Sequence[Token]) -> bool:
    """A table without values of its own, which a target has."""
    return is_table(argument) and len(table_fields(argument)) == len(split_values(argument[1:-1], ',;'))


def _problem_of_value(label: str, argument: Argument, given: Sequence[Token], sizes: Sizes) -> Iterator[str]:
    if len(given) != 1 or given[0].kind not in ('number', 'string'):
        return
    (token,) = given
    value: bytes | float = token.text.encode() if token.kind == 'string' else _number(token.text)
    if (valid := valid_text(argument, value, sizes)) is not None:
        shown = token.text if isinstance(value, float) else f"the string '{token.text}'"
        yield f'{label} = {shown}; valid is {valid}'


def _problems_of_options(function: LuaFunction, table: Sequence[Token], sizes: Sizes) -> Iterator[str]:
    valid = option_arguments(function)
    for key, given in table_fields(table).items():
        if key == 'on_path':
            yield from _problems_of_switches(given)
        elif key in valid:
            yield from _problem_of_value(f'options.{key}', valid[key], given, sizes)
        else:
            yield unknown_option(function, key)


def _problems_of_switches(given: Sequence[Token]) -> Iterator[str]:
    if not is_table(given):
        return
    if fields := table_fields(given):
        if (problem := wrong_switch('on_path', fields)) is not None:
            yield problem
        return
    for i, entry in enumerate(split_values(given[1:-1], ',;'), 1):
        if is_table(entry) and (problem := wrong_switch(f'on_path[{i}]', table_fields(entry))) is not None:
            yield problem


def _single(argument: list[Token]) -> bool:
    """One value: neither a call nor `...`, which may be several."""
    return (
        not argument
        or (argument[-1].text not in (')', '...') and argument[0].kind != 'keyword')
        or (argument[0].text == '(' and closing(argument, 0) == len(argument) - 1)
    )


def _number(text: str) -> float:
    try:
        return float.fromhex(text) if text.lower().startswith('0x') else float(text)
    except (ValueError, OverflowError):
        return float('inf')
