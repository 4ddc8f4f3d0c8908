"""robots list, show and check: which robots there are, and what is known of each."""

import argparse
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from rich.columns import Columns
from rich.console import Console
from rich.markup import escape

from robots_controller.commands.json_output import print_json
from robots_controller.commands.robot_facts import robot_facts
from robots_controller.commands.robot_picture import robot_picture
from robots_controller.terminal_table import Kind, TerminalTable
from robots_core.errors import UnreadableFileError
from robots_core.exit_codes import ExitCode
from robots_core.files.user_file import is_file
from robots_core.robot_choice import URDF_PREFIX, XACRO_PREFIX, available_robot_models, load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Mesh

LIST: Final[tuple[tuple[str, Kind], ...]] = (
    ('name', 'text'),
    ('axes', 'number'),
    ('reach m', 'number'),
    ('payload kg', 'number'),
    ('mass kg', 'number'),
    ('closed form', 'text'),
    ('source', 'code'),
)
JOINTS: Final[tuple[tuple[str, Kind], ...]] = (
    ('axis', 'text'),
    ('lowest', 'number'),
    ('highest', 'number'),
    ('', 'text'),
    ('speed /s', 'number'),
    ('acceleration /s^2', 'number'),
    ('torque N m (N)', 'number'),
)

SMALL: Final = 18, 7
"""Largest size of a picture in the list: characters of a line, lines."""


def list_robots(options: argparse.Namespace, console: Console) -> int:
    """Print a table of the installed robots, in a terminal with pictures; returns an exit code."""
    robots = [load_robot_model(name) for name in available_robot_models()]
    facts = [robot_facts(robot) for robot in robots]
    if options.json:
        print_json(facts)
        return ExitCode.OK
    rows = [
        (
            escape(one['name']),
            str(one['axes']),
            f'{one["reach"]:.2f}',
            '-' if one['payload'] is None else f'{one["payload"]:g}',
            f'{one["mass"]:.0f}',
            'yes' if one['closed_form'] else 'no',
            escape(one['source']),
        )
        for one in facts
    ]
    TerminalTable(LIST, rows).show(console)
    if console.is_terminal:
        pictures = [f'{escape(robot.name)}\n{robot_picture(robot, *SMALL)}\n' for robot in robots]
        console.print(Columns(pictures, equal=True), highlight=False, soft_wrap=False)
    console.print(f'{len(rows)} robots; robots show NAME describes one')
    return ExitCode.OK


def show_robot(options: argparse.Namespace, console: Console) -> int:
    """Print what is known of a robot; returns an exit code."""
    return _show(load_robot_model(options.robot), options, console)


def check_robot(options: argparse.Namespace, console: Console) -> int:
    """Print what a URDF has, what it lacks and what was taken in its place; returns an exit code.

    Raises:
        UnknownRobotError: no robot can be made of it.
    """
    name = options.robot
    if not name.startswith((URDF_PREFIX, XACRO_PREFIX)):
        file = Path(name.partition('?')[0])
        if not is_file(file):
            raise UnreadableFileError(
                f'there is no file {str(file)!r}; robots show takes the names of installed robots'
            )
        name = f'{XACRO_PREFIX if file.suffix == ".xacro" else URDF_PREFIX}{name}'
    robot = load_robot_model(name)
    code = _show(robot, options, console)
    if not options.json:
        count = len(robot.substitutions)
        console.print(
            '[bold green]nothing is missing[/]'
            if not count
            else f'[bold yellow]usable, with {count} substitution{"" if count == 1 else "s"}[/]; '
            'option strict=true refuses them'
        )
    return code


def _show(robot: BaseRobotModel, options: argparse.Namespace, console: Console) -> int:
    facts = robot_facts(robot)
    if options.json:
        print_json(facts)
        return ExitCode.OK
    console.print(f'[bold]{escape(robot.name)}[/], {facts["axes"]} axes')
    if console.is_terminal:
        console.print(robot_picture(robot), highlight=False)
    TerminalTable(JOINTS, [_joint_row(joint) for joint in facts['joints']]).show(console)
    for text in _sentences(robot, facts):
        # A line of a pipe is one of a file; on a terminal it is cut between words.
        console.print(text, soft_wrap=not console.is_terminal)
    return ExitCode.OK


def _sentences(robot: BaseRobotModel, facts: Mapping[str, Any]) -> Iterator[str]:
    payload = '' if facts['payload'] is None else f', rated payload {facts["payload"]:g} kg'
    yield f'tool0 reaches {facts["reach"]:.2f} m from the base; mass {facts["mass"]:.1f} kg{payload}'
    form = 'in closed form and numerical' if facts['closed_form'] else 'numerical'
    yield f'inverse kinematics: {form}'
    yield f'home: {_home(robot)}'
    yield f'to show: {_shapes(robot, "visualization")}; for collisions: {_shapes(robot, "collision_model")}'
    others = {key: value for key, value in facts['dimensions'].items() if key != 'rated_payload_kg'}
    if others:
        yield 'dimensions: ' + escape(', '.join(f'{key} {value}' for key, value in others.items()))
    if facts['source']:
        yield f'source: {escape(facts["source"])}'
    for sentence in facts['substitutions']:
        yield f'[yellow]{escape(sentence)}[/]'


def _joint_row(joint: dict[str, Any]) -> tuple[str, ...]:
    slides = joint['prismatic']
    scale = 1.0 if slides else math.degrees(1.0)
    bounds = [
        '-' if math.isinf(joint[name]) else f'{scale * joint[name]:.{3 if slides else 1}f}'
        for name in ('lower', 'upper')
    ]
    rates = [f'{scale * joint[name]:.4g}' for name in ('velocity', 'acceleration')]
    return escape(joint['name']), *bounds, 'm' if slides else 'deg', *rates, f'{joint["effort"]:.4g}'


def _home(robot: BaseRobotModel) -> str:
    return ', '.join(
        f'{value:.3f} m' if slides else f'{math.degrees(value):.1f} deg'
        for value, slides in zip(robot.home, robot.axes_data.prismatic, strict=True)
    )


def _shapes(robot: BaseRobotModel, which: str) -> str:
    shapes = getattr(robot, which).shapes
    meshes = sum(isinstance(shape.geometry, Mesh) for shape in shapes)
    return f'{meshes} meshes and {len(shapes) - meshes} simple bodies'
