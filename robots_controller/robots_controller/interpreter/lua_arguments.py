"""Checks of the arguments of Lua calls: what came, and what would be valid."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from robots_controller.degrees import to_si
from robots_controller.interpreter.functions.lua_function import (
    ANCHORS,
    COMPARISONS,
    FRAMES,
    Argument,
    Kind,
    LuaFunction,
)
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable
from robots_controller.io.io_image import LABEL, IoImage
from robots_controller.program.motion_command import PathSwitch
from robots_core.orientation import ORIENTATION_CONVENTIONS

POSE_ARGUMENTS: Final = tuple(
    Argument(name, 'number', unit, '')
    for name, unit in (('x', 'm'), ('y', 'm'), ('z', 'm'), ('phi1', 'deg'), ('phi2', 'deg'), ('phi3', 'deg'))
)


CHANNELS: Final = ('digital input', 'digital output', 'analog input', 'analog output')


@dataclass(frozen=True)
class Sizes:
    """What bounds arguments.

    Attributes:
        num_axes: n.
        digital: Number of digital inputs, and of outputs.
        analog: Number of analog inputs, and of outputs.
        prismatic: (n,) which axes slide; () for none.
        names: Indices of inputs and outputs by their names, for each of `CHANNELS`; None where names are not
            known, and any may be valid.
    """

    num_axes: int
    digital: int
    analog: int
    prismatic: tuple[bool, ...] = ()
    names: Mapping[str, Mapping[str, int]] | None = None

    @classmethod
    def of(cls, num_axes: int, io: IoImage, prismatic: tuple[bool, ...] = ()) -> Sizes:
        """Those of a program with these inputs and outputs."""
        names: dict[str, dict[str, int]] = {kind: {} for kind in CHANNELS}
        for channel in io.channels:
            if channel.label:
                names[f'{channel.kind} {channel.direction}'][channel.label] = channel.index
        return cls(num_axes, io.size('digital_inputs'), io.size('analog_inputs'), prismatic, names)

    def count(self, kind: str) -> int:
        """Number of inputs or outputs of a kind."""
        return self.digital if kind.startswith('digital') else self.analog


@dataclass(frozen=True)
class MotionOptions:
    """The table of options of a motion call, SI.

    Attributes:
        blend: Zone of the corner, m or rad; 0 for none.
        switches: Outputs to switch on the way.
    """

    blend: float = 0.0
    switches: tuple[PathSwitch, ...] = ()


@dataclass(frozen=True)
class Arguments:
    """Checked arguments.

    Attributes:
        values: SI numbers, texts, or lists of six SI numbers for poses; None for one that was left out.
        options: Those of a motion.
    """

    values: list[Any]
    options: MotionOptions


def check_arguments(function: LuaFunction, given: Sequence[LuaArgument], sizes: Sizes) -> Arguments:
    """Check the arguments of a call and convert them to SI.

    Raises:
        LuaCallError: naming the function, the argument, what came and what is valid.
    """
    name, given = function.name, list(given)
    options = MotionOptions()
    if function.options:
        given, table = _without_options(given)
        if table is not None:
            options = _check_options(function, table, sizes)
    if given and function.arguments and function.arguments[0].kind == 'number':
        given = _spread(name, given)
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
        values.append(_check(name, label, argument, value, sizes, sliding=sliding))
    return Arguments(values, options)


def wanted_arguments(function: LuaFunction, num_axes: int, given: int) -> list[tuple[str, Argument]]:
    """Name and argument for each that may come.

    Args:
        function: Whose.
        num_axes: n.
        given: How many came.
    """
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
    many = f'{needed}' if needed == len(wanted) else f'{needed} to {len(wanted)}'
    return f'{function.name}: got {given} arguments, needed are {many}' + (f': {names}' if names else '')


def _without_options(given: list[LuaArgument]) -> tuple[list[LuaArgument], LuaTable | None]:
    table = given[-1].value if given else None
    if isinstance(table, LuaTable) and not table.values and (table.fields or len(given) > 1):
        return given[:-1], table
    return given, None


def _spread(name: str, given: list[LuaArgument]) -> list[LuaArgument]:
    table = given[0].value
    if not (isinstance(table, LuaTable) and (table.values or len(given) == 1)):
        return given
    if table.fields and table.values:
        raise LuaCallError(
            f'{name}: {next(iter(table.fields))} stands among the values of the target; options are a table '
            f'of their own: {name}({{...}}, {{blend = ...}})'
        )
    # A table with something after it is an argument like any other: it may not be a target.
    if len(given) > 1 and given[1].type != 'string':
        return given
    return [*table.values, *given[1:]]


def _check(
    function: str, label: str, argument: Argument, given: LuaArgument, sizes: Sizes, *, sliding: bool
) -> Any:
    if argument.kind == 'pose':
        return _check_pose(function, label, given, sizes)
    if argument.kind == 'joints':
        return _check_joints(function, label, given, sizes)
    value = _converted(argument, given, sizes, sliding=sliding)
    if value is None:
        unit = f' {argument.unit}' if argument.unit and given.type == 'number' else ''
        valid = _valid(argument.kind, sizes)
        raise LuaCallError(f'{function}: {label} = {shown(given)}{unit}; valid is {valid}')
    return value


def _converted(argument: Argument, given: LuaArgument, sizes: Sizes, *, sliding: bool) -> Any:
    """The value in SI, the index of an input or output, or the text; None if it is not valid."""
    kind = argument.kind
    match given.value:
        case bool() as flag:
            return float(flag) if kind == 'switch' else None
        case bytes() as text:
            return _text_value(kind, text.decode(errors='replace'), sizes)
        case int() | float() as value if kind in _NUMBERS:
            number = float(value)
            high = sizes.count(kind) if kind in CHANNELS else math.inf
            if math.isfinite(number) and _NUMBERS[kind](number) and number <= high:
                return to_si(number, argument.unit, sliding=sliding)
    return True if kind == given.type == 'function' else None


def _text_value(kind: Kind, text: str, sizes: Sizes) -> Any:
    if kind in CHANNELS:
        if sizes.names is None:
            return text if LABEL.fullmatch(text) else None
        return sizes.names[kind].get(text)
    return text if kind in _TEXTS and _TEXTS[kind](text) else None


def _check_pose(function: str, label: str, given: LuaArgument, sizes: Sizes) -> list[float]:
    table = given.value
    if not isinstance(table, LuaTable) or len(table.values) != 6 or table.fields:
        came = f'a table with {len(table.values)} values' if isinstance(table, LuaTable) else shown(given)
        raise LuaCallError(f'{function}: {label} = {came}; valid is {_valid("pose", sizes)}')
    return [
        _check(function, f'{label}.{argument.name}', argument, entry, sizes, sliding=False)
        for argument, entry in zip(POSE_ARGUMENTS, table.values, strict=True)
    ]


def _check_joints(function: str, label: str, given: LuaArgument, sizes: Sizes) -> list[float]:
    table, n = given.value, sizes.num_axes
    if not isinstance(table, LuaTable) or len(table.values) != n or table.fields:
        came = f'a table with {len(table.values)} values' if isinstance(table, LuaTable) else shown(given)
        raise LuaCallError(f'{function}: {label} = {came}; valid is {_valid("joints", sizes)}')
    joint, prismatic = Argument('q', 'number', 'deg (m)', ''), sizes.prismatic or (False,) * n
    return [
        _check(function, f'{label}[{i}]', joint, entry, sizes, sliding=sliding)
        for i, (entry, sliding) in enumerate(zip(table.values, prismatic, strict=True), 1)
    ]


def valid_text(argument: Argument, value: bytes | float, sizes: Sizes) -> str | None:
    """What would be valid, if a literal number or string is not; None if it is.

    Args:
        argument: Which argument.
        value: The number or string.
        sizes: What bounds it.
    """
    given = LuaArgument('string' if isinstance(value, bytes) else 'number', value)
    try:
        _check('', '', argument, given, sizes, sliding=False)
    except LuaCallError:
        return _valid(argument.kind, sizes)
    return None


# -- options ------------------------------------------------------------------------------------------

_BLENDS: Final = {
    'cartesian': Argument('blend', 'positive', 'm', ''),
    'joint': Argument('jointBlend', 'positive', 'deg', ''),
}


def option_arguments(function: LuaFunction) -> dict[str, Argument]:
    """Options of a motion with one value each, by their names; `on_path` is a table."""
    blend = _BLENDS[function.options]
    return {blend.name: blend}


def unknown_option(function: LuaFunction, key: str) -> str:
    """That there is no such option, and which there are."""
    valid = ', '.join(f'{name} ({argument.unit})' for name, argument in option_arguments(function).items())
    return f'options has no {key}; valid are {valid} and on_path'


def _check_options(function: LuaFunction, table: LuaTable, sizes: Sizes) -> MotionOptions:
    blend_argument = _BLENDS[function.options]
    blend = 0.0
    switches: tuple[PathSwitch, ...] = ()
    for key, given in table.fields.items():
        if key == blend_argument.name:
            blend = _check(function.name, f'options.{key}', blend_argument, given, sizes, sliding=False)
        elif key == 'on_path':
            switches = _check_switches(function.name, given, sizes)
        else:
            raise LuaCallError(f'{function.name}: {unknown_option(function, key)}')
    return MotionOptions(blend, switches)


def _check_switches(function: str, given: LuaArgument, sizes: Sizes) -> tuple[PathSwitch, ...]:
    table = given.value
    if not isinstance(table, LuaTable):
        raise LuaCallError(f'{function}: options.on_path = {shown(given)}; valid is {_valid_switch()}')
    if table.fields:
        return (_check_switch(function, 'on_path', table, sizes),)
    return tuple(
        _check_switch(
            function, f'on_path[{i}]', entry.value if isinstance(entry.value, LuaTable) else None, sizes
        )
        for i, entry in enumerate(table.values, 1)
    )


_OUTPUTS: Final[Mapping[str, Kind]] = {'output': 'digital output', 'analog_output': 'analog output'}


def _check_switch(function: str, label: str, table: LuaTable | None, sizes: Sizes) -> PathSwitch:
    fields = dict(table.fields) if table is not None else {}
    if (problem := wrong_switch(label, fields)) is not None:
        raise LuaCallError(f'{function}: {problem}')
    (anchor,), (output,) = _anchors(fields), _outputs(fields)
    kind: Any = 'digital' if output == 'output' else 'analog'

    def value(key: str, argument: Argument) -> float:
        return float(_check(function, f'options.{label}.{key}', argument, fields[key], sizes, sliding=False))

    unit = 'm' if anchor.startswith('distance') else 's'
    return PathSwitch(
        anchor=anchor,  # type: ignore[arg-type]  # one of ANCHORS
        at=value(anchor, Argument(anchor, 'time', unit, '')),
        kind=kind,
        index=int(value(output, Argument(output, _OUTPUTS[output], '', ''))),
        value=value('value', Argument('value', 'switch' if kind == 'digital' else 'number', '', '')),
    )


def wrong_switch(label: str, keys: Collection[str]) -> str | None:
    """What is wrong with the keys of a table that switches an output on the path; None if nothing is.

    Args:
        label: Of the table.
        keys: Its keys.
    """
    if len(_anchors(keys)) == 1 and len(_outputs(keys)) == 1 and len(keys) == 3 and 'value' in keys:
        return None
    return f'options.{label} has {", ".join(sorted(keys)) or "nothing"}; valid is {_valid_switch()}'


def _anchors(keys: Collection[str]) -> list[str]:
    return [key for key in keys if key in ANCHORS]


def _outputs(keys: Collection[str]) -> list[str]:
    return [key for key in keys if key in _OUTPUTS]


def _valid_switch() -> str:
    return (
        f'{{{ANCHORS[0]} (m) | {" | ".join(ANCHORS[1:])} = ..., output | analog_output = index, value = ...}}'
    )


# -- values -------------------------------------------------------------------------------------------


def _whole_number(value: float) -> bool:
    return value >= 1.0 and value.is_integer()


_NUMBERS: Final[Mapping[Kind, Callable[[float], bool]]] = {
    'number': lambda _: True,
    'time': lambda value: value >= 0.0,
    'fraction': lambda value: 0.0 < value <= 1.0,
    'scale': lambda value: 0.0 <= value <= 1.0,
    'positive': lambda value: value > 0.0,
    'switch': lambda value: value in (0.0, 1.0),
    'count': _whole_number,
    **dict.fromkeys(CHANNELS, _whole_number),
}

_TEXTS: Final[Mapping[Kind, Callable[[str], bool]]] = {
    'text': lambda _: True,
    'name': bool,
    'frame': lambda text: text in FRAMES,
    'comparison': lambda text: text in COMPARISONS,
    'convention': lambda text: text in ORIENTATION_CONVENTIONS,
}

_VALID: Final[Mapping[Kind, str]] = {
    'number': 'a finite number',
    'time': 'a finite number of at least 0',
    'fraction': 'a number above 0, at most 1',
    'scale': 'a number in 0..1',
    'positive': 'a finite number above 0',
    'switch': '0, 1, true or false',
    'text': 'a string',
    'name': 'a string that is not empty',
    'frame': ' or '.join(f"'{frame}'" for frame in FRAMES),
    'comparison': ', '.join(f"'{comparison}'" for comparison in COMPARISONS),
    'convention': ', '.join(f"'{convention}'" for convention in ORIENTATION_CONVENTIONS),
    'function': 'a function',
    'pose': 'a table {x, y, z, phi1, phi2, phi3}',
    'joints': 'a table with a number per axis',
    'count': 'a whole number of at least 1',
}

_SHOWN_TEXT = 40


def _valid(kind: Kind, sizes: Sizes) -> str:
    if kind in CHANNELS:
        names = ''.join(f" or '{name}'" for name in (sizes.names or {}).get(kind, ()))
        return f'a whole number in 1..{sizes.count(kind)}{names}'
    return _VALID[kind]


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
