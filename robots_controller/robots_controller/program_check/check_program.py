"""The work of `check_program`: checks robot programs before anything moves."""

import argparse
import os
import sys
from collections.abc import Iterable
from dataclasses import asdict

from rich.console import Console

from robots_controller.commands.json_output import print_json
from robots_controller.program.files.program_header import ProgramHeader, read_program_header
from robots_controller.program_check.program_check import ProgramProblem, check_program, sizes_of
from robots_core.errors import ProgramError, RobotsError
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model

DEFAULT_ROBOT = 'kuka_kr210_r2700'


def check_programs(options: argparse.Namespace, console: Console) -> int:
    """Print what is wrong with programs, a line per problem, and how many problems there are.

    A program is read first; with --walk, --scene or --io one that reads well is walked in simulation too.

    Returns:
        An exit code: OK if nothing was found.

    Raises:
        RobotsError: an option that is not valid, for all programs.
    """
    if options.robot:
        load_robot_model(options.robot)
    problems: list[ProgramProblem] = []
    bad = 0
    for program in options.programs:
        found = list(_problems(program, options))
        problems += found
        bad += bool(found)
        if not options.json:
            for problem in found:
                console.print(str(problem), markup=False)
    if options.json:
        print_json({'programs': options.programs, 'problems': [asdict(problem) for problem in problems]})
    else:
        count = len(options.programs)
        console.print(f'{_counted(count, "program")}, {_result(len(problems), bad, count)}')
    return ExitCode.FAILED if problems else ExitCode.OK


def _problems(program: str, options: argparse.Namespace) -> Iterable[ProgramProblem]:
    """What is wrong with a program, its header included."""
    given = {'robot': options.robot, 'scene': options.scene, 'io': options.io}
    try:
        cell = read_program_header(program).replaced_by(**given)
        cell.check_files()
        axes = load_robot_model(cell.robot or DEFAULT_ROBOT).axes_data
        size = {'digital': options.digital, 'analog': options.analog}
        sizes = sizes_of(axes.num_axes, cell.io, options.io_map, options.frames, **size)
        problems = check_program(program, sizes)
        if problems or not (options.walk or options.scene or options.io):
            return problems
        return _walk(program, cell, options)
    except ProgramError as error:
        return [ProgramProblem(error.file or program, error.line, error.reason)]
    except RobotsError as error:  # of the header: the other programs are judged anyway
        return [ProgramProblem(program, 0, error.message)]


def _walk(program: str, cell: ProgramHeader, options: argparse.Namespace) -> Iterable[ProgramProblem]:
    # Load the planners, which reading needs not.
    from robots_controller.program_check.walk import walk_program  # noqa: PLC0415
    from robots_controller.simulation.cell_parts import CellSetup  # noqa: PLC0415

    robot = cell.robot or DEFAULT_ROBOT
    setup = CellSetup(program=program, robot=robot, scene=cell.scene, io=cell.io, frames=options.frames)
    result = walk_program(
        setup,
        most=options.combinations,
        longest=options.longest,
        patience=options.patience,
        workers=os.cpu_count() or 1,
    )
    left_out = '' if result.walked == result.possible else f' of {result.possible}; --combinations for more'
    for path in result.paths:
        print(path, file=sys.stderr)
    print(
        f'{program}: walked with {_counted(result.walked, "combination")} of inputs{left_out}',
        file=sys.stderr,
    )
    return result.problems


def _counted(count: int, noun: str) -> str:
    return f'{count} {noun}{"" if count == 1 else "s"}'


def _result(problems: int, bad: int, count: int) -> str:
    if not problems:
        return 'no findings'
    return _counted(problems, 'finding') + ('' if count == 1 else f' in {bad} of them')
