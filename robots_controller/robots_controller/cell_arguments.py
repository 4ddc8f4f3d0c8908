"""What the command lines of `cell` and `simulate` have in common."""

import argparse
import atexit
import gc
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from rich.console import Console
from rich.markup import escape

from robots_controller.program.program_header import HEADER_FILES, ProgramHeader, read_program_header
from robots_core.blocks.drives.drive_level import DRIVE_LEVELS
from robots_core.blocks.following.following_methods import METHODS
from robots_core.blocks.multibody.payload import payload_of
from robots_core.errors import RobotsError
from robots_core.operating_modes import OperatingMode
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.motion_settings import NOTHING

EXIT_OK, EXIT_FAILED, EXIT_BAD_INPUT, EXIT_INTERRUPTED = 0, 1, 2, 130
CELL_OPTIONS: Final = (
    *('robot', 'drive', 'scene', 'io', 'io_map', 'rate', 'goal_tolerance', 'tool_speed_limit'),
    *('operating_mode', 'payload', 'references', 'contact', 'orbit', 'cabin', 'guided'),
)
"""Names of the options that say what a cell is made of."""
LOG_WIDTH: Final = 160  # characters; a log file has no width of its own, and tables need this much


def add_cell_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that say what a cell is made of."""
    parser.add_argument('--robot', default='', help='name of the robot, or urdf:/path/to/robot.urdf')
    parser.add_argument(
        '--drive',
        default='second_order',
        choices=DRIVE_LEVELS,
        help='level of detail of the simulated drives',
    )
    parser.add_argument(
        '--scene', default='', metavar='FILE', help='scene with which the robot must not collide (YAML)'
    )
    parser.add_argument('--io', default='', metavar='FILE', help='scripted PLC to play (YAML)')
    parser.add_argument(
        '--io-map', default='', metavar='FILE', help='map of inputs and outputs to the topics of a PLC (YAML)'
    )
    parser.add_argument(
        '--payload',
        type=_payload,
        default=NOTHING,
        metavar='KG,X,Y,Z',
        help='payload: mass, centre of mass in tool0 (m), optionally inertia XX,XY,XZ,YY,YZ,ZZ (kg m^2)',
    )
    parser.add_argument(
        '--rate', type=float, default=250.0, help='rate of the references, Hz; %(default)g by default'
    )
    parser.add_argument(
        '--goal-tolerance',
        type=float,
        help='largest error with which an axis counts as being at its target, rad',
    )
    parser.add_argument(
        '--tool-speed-limit',
        type=float,
        default=0.0,
        metavar='M_PER_S',
        help='highest speed of the tool and of the frames of all axes on every motion; 0 for no limit',
    )
    parser.add_argument(
        '--operating-mode',
        default=OperatingMode.AUTOMATIC.value,
        choices=tuple(OperatingMode),
        help='determines who may command the robot, and how fast it may move; %(default)s by default',
    )
    parser.add_argument(
        '--references', default='', metavar='BAG', help='recording whose messages guide or jog the robot'
    )
    parser.add_argument(
        '--contact',
        default='',
        metavar='FILE',
        help='what the tool touches, and force control that guides the robot there (YAML)',
    )
    parser.add_argument(
        '--orbit',
        default='',
        metavar='FILE',
        help="what the robot's base floats with in orbit: a target, a gripper, reaction wheels (YAML)",
    )
    parser.add_argument(
        '--cabin',
        default='',
        metavar='FILE',
        help='cabin that the robot moves so that a person in it feels a vehicle (YAML)',
    )
    parser.add_argument(
        '--guided',
        default='',
        choices=METHODS,
        help='inverse kinematics with which the robot follows reference_pose',
    )

    parser.add_argument(
        '--no-check',
        dest='check',
        action='store_false',
        help='run the program even if check_program finds something wrong with it',
    )


def _payload(text: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(','))
        payload_of(values)
    except (ValueError, RobotsError) as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return values


def take_from_program(options: argparse.Namespace) -> None:
    """Take what of its cell was not given from the program; `options.note` is for a person.

    Raises:
        RobotsError: a program that does not exist.
    """
    header = ProgramHeader()
    if options.program:
        if not Path(options.program).is_file():
            raise RobotsError(f'program {options.program!r} not found; programs are Lua files, see programs/')
        header = read_program_header(options.program)
    own = {name: getattr(options, name) for name in ('robot', *HEADER_FILES)}
    chosen = header.replaced_by(**own)
    for name in own:
        setattr(options, name, getattr(chosen, name))
    options.note = header.note(options.program, chosen.robot)


def show_substitutions(robot: BaseRobotModel, console: Console) -> None:
    """Say what the robot's files lack, and what was taken in its place."""
    for sentence in robot.substitutions:
        console.print(f'[yellow]{escape(robot.name)}: {escape(sentence)}[/]')


def exit_code(run: Callable[[Console], int]) -> int:
    """Run with a console; what is wrong with the input, and Ctrl-C, end it with codes of their own."""
    # A process that ends need not look through all that it has loaded: that takes half a second.
    atexit.register(gc.freeze)
    console = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else LOG_WIDTH)
    try:
        return run(console)
    except RobotsError as error:
        print(f'error: {error}', file=sys.stderr)
        return EXIT_BAD_INPUT
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED
