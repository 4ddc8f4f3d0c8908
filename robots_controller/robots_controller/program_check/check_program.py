"""check_program: checks robot programs before anything moves."""

import argparse
import os
import sys
from collections.abc import Sequence

from robots_controller.cell_arguments import exit_code
from robots_controller.interpreter.lua_program import ANALOG_SIZE, DIGITAL_SIZE
from robots_controller.program.program_header import ProgramHeader, read_program_header
from robots_controller.program_check.first_check import sizes_of
from robots_controller.program_check.program_check import check_program
from robots_controller.program_check.walk import LONGEST_TIME, MOST_COMBINATIONS, walk_program
from robots_core.errors import ProgramError
from robots_core.robot_choice import load_robot_model

DEFAULT_ROBOT = 'kuka_kr210_r2700'


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what is wrong with programs, a line per problem.

    A program is read first; with --walk, --scene or --io one that reads well is walked in simulation too.

    Returns:
        0 if nothing was found, 1 for problems, 2 for an unknown robot or a file that is not valid.
    """
    options = _options(arguments)
    return exit_code(lambda _: max(_check(program, options) for program in options.programs))


def _check(program: str, options: argparse.Namespace) -> bool:
    """Print the problems of a program; true if there are any."""
    given = {'robot': options.robot, 'scene': options.scene, 'io': options.io}
    try:
        cell = read_program_header(program).replaced_by(**given)
    except ProgramError:  # the check says what is wrong with the file
        cell = ProgramHeader(**given)
    robot = cell.robot or DEFAULT_ROBOT
    axes = load_robot_model(robot).axes_data
    sizes = sizes_of(axes.num_axes, cell.io, options.io_map, digital=options.digital, analog=options.analog)
    problems = check_program(program, sizes)
    if not problems and (options.walk or options.scene or options.io):
        result = walk_program(
            program,
            robot=robot,
            scene=cell.scene,
            io=cell.io,
            most=options.combinations,
            longest=options.longest,
            workers=os.cpu_count() or 1,
        )
        problems = result.problems
        left_out = (
            '' if result.walked == result.possible else f' of {result.possible}; --combinations for more'
        )
        for way in result.ways:
            print(way, file=sys.stderr)
        print(f'{program}: walked with {result.walked} combinations of inputs{left_out}', file=sys.stderr)
    for problem in problems:
        print(problem)
    return bool(problems)


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog='check_program', description='Check robot programs before anything moves.'
    )
    parser.add_argument('programs', nargs='+', metavar='PROGRAM', help='Lua files')
    parser.add_argument(
        '--robot',
        default='',
        help='robot to check the programs for; by default the one that each program names',
    )
    parser.add_argument(
        '--digital', type=int, default=DIGITAL_SIZE, help='number of digital inputs and outputs'
    )
    parser.add_argument('--analog', type=int, default=ANALOG_SIZE, help='number of analog inputs and outputs')
    parser.add_argument('--walk', action='store_true', help='simulate the programs too')
    parser.add_argument('--scene', default='', metavar='FILE', help='simulate, with this scene (YAML)')
    parser.add_argument(
        '--io',
        default='',
        metavar='FILE',
        help='simulate, with all combinations of the inputs of this PLC script',
    )
    parser.add_argument(
        '--io-map',
        default='',
        metavar='FILE',
        help='names of inputs and outputs: a map to the topics of a PLC',
    )
    parser.add_argument(
        '--combinations',
        type=int,
        default=MOST_COMBINATIONS,
        help='largest number of combinations to simulate',
    )
    parser.add_argument(
        '--longest', type=float, default=LONGEST_TIME, help='longest simulated time of a combination, s'
    )
    return parser.parse_args(arguments)


if __name__ == '__main__':
    sys.exit(main())
