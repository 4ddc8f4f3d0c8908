"""Values of the arguments of Lua calls: which are valid, and what they are in SI units."""

from __future__ import annotations

import math
from typing import Any, Final

from robots_controller.degrees import to_si
from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import ArgumentKind, Sizes
from robots_controller.interpreter.functions.common_arguments import JOINTS, POSE
from robots_controller.interpreter.functions.lua_function import Argument
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable
from robots_controller.io.io_image import LABEL
from robots_controller.program.files.cell_frames import check_frame
from robots_core.errors import RobotsError

UNKNOWN: Final = LuaArgument('unknown', None)
"""What the run computes, where a program is checked without one: it may be any value."""

_SHOWN_TEXT: Final = 40


def check_value(
    function: str, label: str, argument: Argument, given: LuaArgument, sizes: Sizes, *, sliding: bool = False
) -> Any:
    """A value of an argument in SI, the index of an input or output, or a text.

    Args:
        function: For messages.
        label: Of the value, for messages.
        argument: Which values are valid.
        given: What came.
        sizes: What bounds it.
        sliding: It belongs to an axis that slides.

    Raises:
        LuaCallError: naming the function, the argument, what came and what is valid.
    """
    if given is UNKNOWN:
        return 0.0
    kind, table = argument.kind, given.value if isinstance(given.value, LuaTable) else None
    value, came = None, shown(given)
    if table is None:
        value = _converted(argument, given, sizes, sliding=sliding)
        came += f' {argument.unit}' if argument.unit and given.type == 'number' else ''
    elif kind is kinds.CONDITION:
        value = table if table.fields else None
    elif kind is kinds.VALUE and not table.fields:
        number = Argument('', kinds.NUMBER)
        value = tuple(
            check_value(function, f'{label}[{i}]', number, entry, sizes)
            for i, entry in enumerate(table.values, 1)
        )
    elif kind in (kinds.POSE, kinds.JOINTS):
        parts = _parts(label, kind, sizes)
        if len(table.values) == len(parts) and not table.fields:
            return [
                check_value(function, name, part, entry, sizes, sliding=slides)
                for (name, part, slides), entry in zip(parts, table.values, strict=True)
            ]
        came = f'a table with {len(table.values)} values'
    if value is None:
        hint = _hint(kind, given)
        raise LuaCallError(f'{function}: {label} = {came}; valid is {kind.describe(sizes)}{hint}')
    if kind.frame is not None and sizes.frames_file is not None:
        try:
            check_frame(sizes.frames_file, kind.frame, value)
        except RobotsError as error:
            raise LuaCallError(f'{function}: {error}') from None
    return value


def _hint(kind: ArgumentKind, given: LuaArgument) -> str:
    """The end of a message about a value that is a known mistake; '' for others."""
    value = given.value
    if given.type == 'nil':
        return '; nothing gives it a value, or it is an index that is not there: the first is 1'
    if kind.channel and value == 0:
        return '; the first is 1'
    if kind in (kinds.FRACTION, kinds.SCALE) and isinstance(value, (int, float)) and 1.0 < value <= 100.0:
        return f'; {value:g} % is {0.01 * value:g}'
    return ''


def _parts(label: str, kind: ArgumentKind, sizes: Sizes) -> list[tuple[str, Argument, bool]]:
    """Label and argument for each value of a pose or of all joints, and whether its axis slides."""
    if kind is kinds.POSE:
        return [(f'{label}.{argument.name}', argument, False) for argument in POSE]
    prismatic = sizes.prismatic or (False,) * sizes.num_axes
    return [(f'{label}[{i}]', JOINTS, slides) for i, slides in enumerate(prismatic, 1)]


def _converted(argument: Argument, given: LuaArgument, sizes: Sizes, *, sliding: bool) -> Any:
    """The value in SI, the index of an input or output, or the text; None if it is not valid."""
    kind = argument.kind
    match given.value:
        case bool() as flag:
            return float(flag) if kind is kinds.SWITCH else flag if kind is kinds.VALUE else None
        case bytes() as text:
            return _text_value(kind, text.decode(errors='replace'), sizes)
        case int() | float() as value if kind is kinds.VALUE:
            return value if math.isfinite(value) else None
        case int() | float() as value if kind.number is not None:
            number = float(value)
            high = sizes.count(kind.channel) if kind.channel else math.inf
            if math.isfinite(number) and kind.number(number) and number <= high:
                return to_si(number, argument.unit, sliding=sliding)
    return True if kind is kinds.FUNCTION and given.type == 'function' else None


def _text_value(kind: ArgumentKind, text: str, sizes: Sizes) -> Any:
    if kind.channel:
        if sizes.names is None:
            return text if LABEL.fullmatch(text) else None
        return sizes.names[kind.channel].get(text)
    return text if kind.text is not None and kind.text(text) else None


def shown(given: LuaArgument) -> str:
    """A value as messages show it."""
    value = given.value
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, bytes):
        text = value.decode(errors='replace')
        return f"the string '{text[:_SHOWN_TEXT]}{'...' if len(text) > _SHOWN_TEXT else ''}'"
    if value is None or isinstance(value, LuaTable):
        return 'nil' if given.type == 'nil' else f'a {given.type}'
    return f'{value:.10g}' if isinstance(value, float) else str(value)
