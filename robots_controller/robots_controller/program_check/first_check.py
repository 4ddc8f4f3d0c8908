"""The check of a program that `cell` and `simulate` make before anything starts."""

import sys
from dataclasses import replace
from pathlib import Path

from robots_controller.defaults import ANALOG_SIZE, DIGITAL_SIZE
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.io.cell_io import read_cell_io
from robots_controller.io.io_image import IoImage
from robots_controller.program_check.program_check import check_program
from robots_core.errors import ProgramError


def sizes_of(
    num_axes: int,
    io: Path | str = '',
    io_map: Path | str = '',
    frames: Path | str = '',
    *,
    digital: int = DIGITAL_SIZE,
    analog: int = ANALOG_SIZE,
) -> Sizes:
    """What bounds the arguments of a program.

    Args:
        num_axes: Of its robot.
        io: Script of a PLC; '' for none.
        io_map: Map of inputs and outputs; '' for none.
        frames: Frames file; '' for the one beside the program.
        digital: Number of digital inputs, and of outputs.
        analog: Number of analog inputs, and of outputs.

    Raises:
        RobotsError: a file that is not valid.
    """
    file = Path(frames) if frames else None
    if not (io or io_map):
        return Sizes(num_axes, digital, analog, frames_file=file)
    labels = read_cell_io(io, io_map).labels
    image = IoImage(digital=digital, analog=analog, labels=labels)
    return replace(Sizes.of(num_axes, image), frames_file=file)


def check_first(program: Path | str, sizes: Sizes) -> None:
    """Print what is wrong with a program, as `check_program` does.

    Raises:
        RobotsError: something is.
    """
    problems = check_program(program, sizes)
    for problem in problems:
        print(problem, file=sys.stderr)
    if problems:
        count = f'{len(problems)} problems' if len(problems) > 1 else 'a problem'
        raise ProgramError(
            f'{Path(program).name} has {count}, and nothing was started; --no-check runs it anyway'
        )
