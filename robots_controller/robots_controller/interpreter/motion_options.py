"""MotionOptions: the table of options that a motion call may end with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.argument_kinds import ANCHORS, ArgumentKind, Sizes
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.lua_sandbox import LuaArgument, LuaCallError, LuaTable
from robots_controller.interpreter.lua_values import UNKNOWN, check_value, shown
from robots_controller.program.motions.motion_command import PathSwitch
from robots_core.wording.nearest_name import did_you_mean


@dataclass(frozen=True)
class Condition:
    """What ends a motion on its path.

    Attributes:
        met: It holds.
        period: How often it is evaluated, s; None where it is evaluated at changes of inputs alone.
    """

    met: Callable[[], bool]
    period: float | None = None


@dataclass(frozen=True)
class MotionOptions:
    """The table of options of a motion call, SI.

    Attributes:
        blend: Zone of the corner, m or rad; 0 for none.
        avoid: Whether this motion goes around obstacles; None as it is set.
        on_blocked: What an obstacle does that comes into its path, one of `ON_BLOCKED`; None as it is set.
        switches: Outputs to switch on the way.
        until: Ends the motion where it holds.
    """

    blend: float = 0.0
    avoid: bool | None = None
    on_blocked: str | None = None
    switches: tuple[PathSwitch, ...] = ()
    until: Condition | None = None


_BLENDS: Final = {
    'cartesian': Argument('blend', kinds.POSITIVE, 'm'),
    'joint': Argument('jointBlend', kinds.POSITIVE, 'deg'),
}

_AVOID: Final = Argument('avoid', kinds.SWITCH)
_ON_BLOCKED: Final = Argument('on_blocked', kinds.ON_BLOCKED)


def check_options(function: LuaFunction, table: LuaTable, sizes: Sizes) -> MotionOptions:
    """Check the options of a call.

    Raises:
        LuaCallError: naming the option, what came and what is valid.
    """
    blend = _BLENDS[function.options]
    # What moves on a path of the tool does not leave it.
    joint = {'on_blocked': _ON_BLOCKED} if function.options == 'joint' else {}
    known = {blend.name: blend, 'avoid': _AVOID, **joint}
    values: dict[str, Any] = {}
    for key, given in table.fields.items():
        if key in known:
            values[key] = check_value(function.name, f'options.{key}', known[key], given, sizes)
        elif key == 'on_path':
            values['switches'] = _check_switches(function.name, given, sizes)
        else:
            raise LuaCallError(
                f'{function.name}: options has no {key}{did_you_mean(key, (*known, "on_path"))}; valid are '
                f'{blend.name} ({blend.unit}), {", ".join([*known][1:])} and on_path'
            )
    if 'avoid' in values:
        values['avoid'] = bool(values['avoid'])
    return MotionOptions(blend=values.pop(blend.name, 0.0), **values)


def _check_switches(function: str, given: LuaArgument, sizes: Sizes) -> tuple[PathSwitch, ...]:
    if given is UNKNOWN:
        return ()
    table = given.value
    if not isinstance(table, LuaTable):
        raise LuaCallError(f'{function}: options.on_path = {shown(given)}; valid is {_valid_switch()}')
    if table.fields:
        return (_check_switch(function, 'on_path', given, sizes),)
    return tuple(
        _check_switch(function, f'on_path[{i}]', entry, sizes)
        for i, entry in enumerate(table.values, 1)
        if entry is not UNKNOWN
    )


_OUTPUTS: Final[Mapping[str, ArgumentKind]] = {
    'output': kinds.DIGITAL_OUTPUT,
    'analog_output': kinds.ANALOG_OUTPUT,
}


def _check_switch(function: str, label: str, given: LuaArgument, sizes: Sizes) -> PathSwitch:
    fields = given.value.fields if isinstance(given.value, LuaTable) else {}
    anchors = [anchor for anchor in ANCHORS if anchor in fields]
    outputs = [output for output in _OUTPUTS if output in fields]
    if not (len(anchors) == len(outputs) == 1 and len(fields) == 3 and 'value' in fields):
        has = ', '.join(sorted(fields)) or 'nothing'
        raise LuaCallError(f'{function}: options.{label} has {has}; valid is {_valid_switch()}')
    (anchor,), (output,) = anchors, outputs
    kind: Any = 'digital' if output == 'output' else 'analog'

    def value(key: str, of: ArgumentKind, unit: str = '') -> float:
        argument = Argument(key, of, unit)
        checked = check_value(function, f'options.{label}.{key}', argument, fields[key], sizes)
        if isinstance(checked, str):
            raise LuaCallError(
                f'{function}: options.{label}.{key} = {checked!r}: no I/O map names it; valid is its number'
            )
        return float(checked)

    return PathSwitch(
        anchor=anchor,
        at=value(anchor, kinds.TIME, 'm' if anchor.startswith('distance') else 's'),
        kind=kind,
        index=int(value(output, _OUTPUTS[output])),
        value=value('value', kinds.SWITCH if kind == 'digital' else kinds.NUMBER),
    )


def _valid_switch() -> str:
    return (
        f'{{{ANCHORS[0]} (m) | {" | ".join(ANCHORS[1:])} = ..., output | analog_output = index, value = ...}}'
    )
