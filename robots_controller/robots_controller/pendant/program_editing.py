"""What an editor of robot programs needs: findings, and what functions do."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.io.io_image import IMAGES, IoImage
from robots_controller.pendant.pendant_state import ShownIo
from robots_controller.program_check.program_check import ProgramProblem, check_program
from robots_core.robot_model.axes_data import AxesData


def findings(path: Path, axes: AxesData, io: ShownIo, frames_file: str = '') -> tuple[ProgramProblem, ...]:
    """What `check_program` finds in a program, with this robot and the names of its cell."""
    labels = {image: io.labels.get(image, ()) for image in IMAGES}
    digital, analog = (len(io.values.get(f'{kind}_outputs', ())) for kind in ('digital', 'analog'))
    image = IoImage(digital=digital, analog=analog, labels=labels)
    sizes = Sizes.of(axes.num_axes, image, axes.prismatic)
    return check_program(path, replace(sizes, frames_file=Path(frames_file) if frames_file else None))


@cache
def completions(num_axes: int) -> tuple[dict[str, str], ...]:
    """Names, arguments and meanings of all functions, from the table that `lua_meta` is made of."""
    return tuple(
        {'label': function.name, 'detail': _arguments(function, num_axes), 'info': _info(function)}
        for function in LUA_FUNCTIONS.values()
    )


def _arguments(function: LuaFunction, num_axes: int) -> str:
    names = [name for argument in function.arguments for name in _names(argument, num_axes)]
    return f'({", ".join([*names, *(["options"] if function.options else [])])})'


def _names(argument: Argument, num_axes: int) -> list[str]:
    if argument.per_axis:
        return [f'{argument.name}{index}' for index in range(1, num_axes + 1)]
    name = f'{argument.name}...' if argument.repeated else argument.name
    return [f'[{name}]' if argument.optional else name]


def _info(function: LuaFunction) -> str:
    rows = [
        f'{argument.name}: {argument.meaning}' + (f' ({argument.unit})' if argument.unit else '')
        for argument in function.arguments
    ]
    return '\n'.join([function.doc, *rows, *([f'→ {function.result}'] if function.result else [])])
