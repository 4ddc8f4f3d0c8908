"""What a program adds to the options of `cell` and `simulate`, and what is said before they start."""

import argparse

from rich.console import Console
from rich.markup import escape

from robots_controller.io.io_map import read_io_map
from robots_controller.io.plc_script import read_plc_script
from robots_controller.program.files.program_header import HEADER_FILES, ProgramHeader, read_program_header
from robots_core.errors import UnreadableFileError
from robots_core.files.user_file import is_file
from robots_core.robot_model.base_robot_model import BaseRobotModel


def take_from_program(options: argparse.Namespace) -> None:
    """Take what of its cell was not given from the program; `options.note` is for a person.

    A map that sets the inputs of the program's scripted PLC takes its place.

    Raises:
        RobotsError: a program that does not exist.
    """
    header = ProgramHeader()
    if options.program:
        if not is_file(options.program):
            raise UnreadableFileError(
                f'program {options.program!r} not found; programs are Lua files, see programs/'
            )
        header = read_program_header(options.program)
        if header.io and not options.io and options.io_map and _same_inputs(header.io, options.io_map):
            header = header.without('io')
    names = ('robot', *HEADER_FILES)
    own = {name: getattr(options, name) for name in names}
    chosen = header.replaced_by(**own)
    chosen.check_files()
    for name in own:
        setattr(options, name, getattr(chosen, name))
    options.note = header.note(options.program, chosen.robot)


def _same_inputs(io: str, io_map: str) -> bool:
    """A scripted PLC sets inputs of images that a map sets too."""
    played, mapped = read_plc_script(io).inputs, [row.channel for row in read_io_map(io_map).inputs]
    return not {channel.image for channel in played}.isdisjoint({channel.image for channel in mapped})


def show_substitutions(robot: BaseRobotModel, console: Console) -> None:
    """Say what the robot's files lack, and what was taken in its place."""
    for sentence in robot.substitutions:
        console.print(f'[yellow]{escape(robot.name)}: {escape(sentence)}[/]')
