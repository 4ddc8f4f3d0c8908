"""lua_meta: the editor's help for robot programs, made from the table of functions.

`---@meta` files are those of the Lua language server: https://luals.github.io/wiki/definition-files
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import Final

from rich.console import Console

from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model

# Where no robot is named: what most arms have, and the others as overloads.
USUAL_AXES: Final = 6
OTHER_AXES: Final = (3, 4, 5, 7)

_OPTIONS: Final = {'cartesian': 'CartesianOptions', 'joint': 'JointOptions'}

_ANCHOR_FIELDS: Final = '\n'.join(
    f'---@field {anchor}? number {"m, along the tool path" if anchor.startswith("distance") else "s"}'
    for anchor in kinds.ANCHORS
)

HEADER: Final = f"""---@meta
-- Robot programs: what every function does, for the Lua language server. Generated; do not edit:
-- lua_meta > programs/library/robot_functions.lua, or lua_meta --robot NAME for one robot's axes.

---{{x, y, z, phi1, phi2, phi3}}: metres and degrees; `a * b` chains, b seen from a.
---@class Pose: number[]
---@field x number
---@field y number
---@field z number
---@field phi1 number
---@field phi2 number
---@field phi3 number
---@operator mul(Pose|number[]): Pose

---Switches an output while the robot moves: one place, one output, its value.
---@class PathSwitch
{_ANCHOR_FIELDS}
---@field output? integer|string digital output
---@field analog_output? integer|string analog output
---@field value boolean|number

---What ends a motion: one input or torque, and its value or bounds.
---@class Condition
---@field input? integer|string digital input
---@field value? boolean of the digital input, true by default
---@field analog_input? integer|string
---@field joint_torque? integer number of a joint, its torque in N m (N)
---@field above? number
---@field below? number

---@class CartesianOptions
---@field blend? number m, zone in which the corner to the next motion may be cut
---@field avoid? boolean|0|1 whether joint motions go around obstacles
---@field on_path? PathSwitch|PathSwitch[]

---@class JointOptions
---@field jointBlend? number deg, zone in which the corner to the next motion may be cut
---@field avoid? boolean|0|1 whether joint motions go around obstacles
---@field on_blocked? "stop"|"replan" what an obstacle does that comes into the path of a motion with avoid
---@field on_path? PathSwitch|PathSwitch[]
"""


def meta_file(num_axes: int | None = None) -> str:
    """The definitions of all functions for a robot's number of axes, or for any."""
    return '\n'.join([HEADER, *('\n'.join(_function(f, num_axes)) for f in LUA_FUNCTIONS.values())])


def _function(function: LuaFunction, num_axes: int | None) -> Iterator[str]:
    axes = num_axes or USUAL_AXES
    yield f'---{function.doc}'
    names: list[str] = []
    for argument in function.arguments:
        if argument.repeated:  # whatever follows comes with them
            options = f'|{_OPTIONS[function.options]}' if function.options else ''
            yield f'---@param ... {argument.kind.lua_type}{options} {_meaning(argument)}'
            names.append('...')
            continue
        optional = '?' if argument.optional else ''
        for name in _names(argument, axes):
            yield f'---@param {name}{optional} {argument.kind.lua_type} {_meaning(argument)}'
            names.append(name)
    if function.options and '...' not in names:
        yield f'---@param options? {_OPTIONS[function.options]}'
        names.append('options')
    if function.more:
        yield '---@param ... any'
        names.append('...')
    if function.result_type:
        yield f'---@return {function.result_type} # {function.result}'
    yield from _overloads(function, num_axes)
    if function.by_name is not None:
        yield f'---@overload fun({function.by_name.name}: {function.by_name.kind.lua_type})'
    yield f'function {function.name}({", ".join(names)}) end'
    yield ''


def _overloads(function: LuaFunction, num_axes: int | None) -> Iterator[str]:
    if not function.arguments or function.arguments[0].kind is not kinds.NUMBER:
        return
    options = f', options?: {_OPTIONS[function.options]}' if function.options else ''
    first = function.arguments[0]
    if first.per_axis:
        for axes in () if num_axes else OTHER_AXES:
            listed = ', '.join(f'{name}: {first.kind.lua_type}' for name in _names(first, axes))
            yield f'---@overload fun({listed}{options})'
        yield f'---@overload fun({first.name}: number[]{options})'
    elif sum(argument.kind is kinds.NUMBER for argument in function.arguments) >= 6:
        rest = ''.join(f', {a.name}?: {a.kind.lua_type}' for a in function.arguments[6:])
        yield f'---@overload fun(pose: {kinds.POSE.lua_type}{rest}{options})'


def _names(argument: Argument, axes: int) -> list[str]:
    return [f'{argument.name}{i}' for i in range(1, axes + 1)] if argument.per_axis else [argument.name]


def _meaning(argument: Argument) -> str:
    return f'{argument.meaning} ({argument.unit})' if argument.unit else argument.meaning


def print_definitions(options: argparse.Namespace, _console: Console) -> int:
    """Print the definitions; returns an exit code.

    Raises:
        UnknownRobotError: no such robot.
    """
    print(meta_file(load_robot_model(options.robot).num_axes if options.robot else None), end='')
    return ExitCode.OK
