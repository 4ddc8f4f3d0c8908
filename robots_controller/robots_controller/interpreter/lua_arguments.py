"""Checks of the arguments of Lua calls: what came, and what would be valid."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable
from robots_controller.interpreter.lua_values import UNKNOWN, check_value
from robots_controller.interpreter.motion_options import MotionOptions, check_options


@dataclass(frozen=True)
class Arguments:
    """Checked arguments.

    Attributes:
        values: SI numbers, texts, or lists of six SI numbers for poses; None for one that was left out.
        options: Those of a motion; None for other functions.
        more: What came behind them, as it came.
    """

    values: list[Any]
    options: MotionOptions | None
    more: tuple[LuaArgument, ...] = ()


def check_arguments(function: LuaFunction, given: Sequence[LuaArgument], sizes: Sizes) -> Arguments:
    """Check the arguments of a call and convert them to SI.

    Raises:
        LuaCallError: naming the function, the argument, what came and what is valid.
    """
    name, given = function.name, list(given)
    if function.by_name is not None and len(given) == 1 and given[0].type == 'string':
        return Arguments([check_value(name, function.by_name.name, function.by_name, given[0], sizes)], None)
    options = None
    if function.options:
        given, table = _without_options(given)
        options = MotionOptions() if table is None else check_options(function, table, sizes)
    if given and function.arguments and function.arguments[0].kind is kinds.NUMBER:
        given = _spread(function, given)
    wanted = wanted_arguments(function, sizes.num_axes, len(given))
    needed = sum(not argument.optional for _, argument in wanted)
    if not (needed <= len(given) and (function.more or len(given) <= len(wanted))):
        raise LuaCallError(_wrong_number(function, wanted, needed, len(given)))
    values: list[Any] = []
    for position, (label, argument) in enumerate(wanted):
        value = given[position] if position < len(given) else LuaArgument('nil', None)
        if argument.optional and value.type == 'nil':
            values.append(None)
            continue
        sliding = argument.per_axis and bool(sizes.prismatic) and sizes.prismatic[position]
        values.append(check_value(name, label, argument, value, sizes, sliding=sliding))
    return Arguments(values, options, tuple(given[len(wanted) :]))


def wanted_arguments(function: LuaFunction, num_axes: int, given: int) -> list[tuple[str, Argument]]:
    """Name and argument for each that may come, of a function that got so many."""
    wanted: list[tuple[str, Argument]] = []
    for argument in function.arguments:
        count = num_axes if argument.per_axis else max(given, 1) if argument.repeated else 0
        if count:
            wanted += [(f'{argument.name}{i}', argument) for i in range(1, count + 1)]
        else:
            wanted.append((argument.name, argument))
    return wanted


def _wrong_number(function: LuaFunction, wanted: list[tuple[str, Argument]], needed: int, given: int) -> str:
    if function.arguments and function.arguments[0].per_axis:
        return f'{function.name}: got {given} joint angles, the robot has {len(wanted)} axes'
    names = ', '.join(
        f'[{name}]' if a.optional else f'{name} ({a.unit})' if a.unit else name for name, a in wanted
    )
    names += f'; or {function.by_name.kind.valid}' if function.by_name is not None else ''
    many = f'{needed}' if needed == len(wanted) else f'{needed} to {len(wanted)}'
    return f'{function.name}: got {given} arguments, needed are {many}' + (f': {names}' if names else '')


def _without_options(given: list[LuaArgument]) -> tuple[list[LuaArgument], LuaTable | None]:
    table = given[-1].value if given else None
    if isinstance(table, LuaTable) and not table.values and (table.fields or len(given) > 1):
        return given[:-1], table
    return given, None


def _spread(function: LuaFunction, given: list[LuaArgument]) -> list[LuaArgument]:
    table, name = given[0].value, function.name
    if not (isinstance(table, LuaTable) and (table.values or len(given) == 1)):
        return given
    if table.fields and table.values:
        raise LuaCallError(
            f'{name}: {next(iter(table.fields))} stands among the values of the target; options are a table '
            f'of their own: {name}({{...}}, {{blend = ...}})'
        )
    # A table with something after it is an argument like any other: it may not be a target.
    behind = 'table' if function.arguments[-1].kind is kinds.JOINTS else 'string'
    if len(given) > 1 and given[1] is not UNKNOWN and given[1].type != behind:
        return given
    return [*table.values, *given[1:]]
