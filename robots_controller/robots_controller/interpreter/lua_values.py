"""Values of the arguments of Lua calls: which are valid, and what they are in SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from robots_controller.degrees import to_si
from robots_controller.interpreter.functions.lua_function import COMPARISONS, FRAMES, MOMENTS, Argument, Kind
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable
from robots_controller.io.io_image import LABEL, IoImage
from robots_core.blocks.inverse_kinematics.hold import HOLDS
from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_core.robot_model.analytic.configuration import CONFIGURATIONS
from robots_planning.motion_kinds import KIND_OF_FUNCTION
from robots_planning.planner_choice import available_planners

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
    if argument.kind == 'pose':
        return _check_pose(function, label, given, sizes)
    if argument.kind == 'condition' and isinstance(given.value, LuaTable) and given.value.fields:
        return given.value
    if argument.kind == 'value':
        return _check_plain_value(function, label, given, sizes)
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
        check_value(function, f'{label}.{argument.name}', argument, entry, sizes)
        for argument, entry in zip(POSE_ARGUMENTS, table.values, strict=True)
    ]


def _check_joints(function: str, label: str, given: LuaArgument, sizes: Sizes) -> list[float]:
    table, n = given.value, sizes.num_axes
    if not isinstance(table, LuaTable) or len(table.values) != n or table.fields:
        came = f'a table with {len(table.values)} values' if isinstance(table, LuaTable) else shown(given)
        raise LuaCallError(f'{function}: {label} = {came}; valid is {_valid("joints", sizes)}')
    joint, prismatic = Argument('q', 'number', 'deg (m)', ''), sizes.prismatic or (False,) * n
    return [
        check_value(function, f'{label}[{i}]', joint, entry, sizes, sliding=sliding)
        for i, (entry, sliding) in enumerate(zip(table.values, prismatic, strict=True), 1)
    ]


def _check_plain_value(function: str, label: str, given: LuaArgument, sizes: Sizes) -> Any:
    value = given.value
    if isinstance(value, LuaTable) and not value.fields:
        number = Argument('', 'number', '', '')
        return tuple(
            check_value(function, f'{label}[{i}]', number, entry, sizes)
            for i, entry in enumerate(value.values, 1)
        )
    if isinstance(value, bytes):
        return value.decode(errors='replace')
    if isinstance(value, bool) or (isinstance(value, (int, float)) and math.isfinite(value)):
        return value
    raise LuaCallError(f'{function}: {label} = {shown(given)}; valid is {_valid("value", sizes)}')


def valid_text(argument: Argument, value: bytes | float, sizes: Sizes) -> str | None:
    """What would be valid, if a literal number or string is not; None if it is.

    Args:
        argument: Which argument.
        value: The number or string.
        sizes: What bounds it.
    """
    given = LuaArgument('string' if isinstance(value, bytes) else 'number', value)
    try:
        check_value('', '', argument, given, sizes)
    except LuaCallError:
        return _valid(argument.kind, sizes)
    return None


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
    'hold': lambda text: text in HOLDS,
    'motion': lambda text: text in KIND_OF_FUNCTION,
    'moment': lambda text: text in MOMENTS,
    'joint_planner': lambda text: text in available_planners('joint_planner'),
    'cartesian_planner': lambda text: text in available_planners('cartesian_planner'),
    'configuration': lambda text: text in CONFIGURATIONS,
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
    'hold': ', '.join(f"'{hold}'" for hold in HOLDS),
    'convention': ', '.join(f"'{convention}'" for convention in ORIENTATION_CONVENTIONS),
    'function': 'a function',
    'motion': f'a function that moves the robot: {", ".join(KIND_OF_FUNCTION)}',
    'moment': ' or '.join(f"'{moment}'" for moment in MOMENTS),
    'configuration': ', '.join(f"'{configuration}'" for configuration in CONFIGURATIONS),
    'condition': 'a table with a condition',
    'value': 'a finite number, a string, true, false, nil or a list of numbers',
    'pose': 'a table {x, y, z, phi1, phi2, phi3}',
    'joints': 'a table with a number per axis',
    'count': 'a whole number of at least 1',
}

_SHOWN_TEXT = 40


def _valid(kind: Kind, sizes: Sizes) -> str:
    if kind in CHANNELS:
        names = ''.join(f" or '{name}'" for name in (sizes.names or {}).get(kind, ()))
        return f'a whole number in 1..{sizes.count(kind)}{names}'
    if kind in ('joint_planner', 'cartesian_planner'):
        return ', '.join(f"'{planner}'" for planner in available_planners(kind))
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
