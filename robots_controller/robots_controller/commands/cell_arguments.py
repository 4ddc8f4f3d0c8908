"""What `cell` and `simulate` take."""

import argparse
from typing import Final

from robots_controller.commands import value_kinds as kinds
from robots_controller.defaults import LONGEST_TIME
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.following.following_methods import METHODS
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.defaults import RATE
from robots_core.periodic.watchdog import WATCHDOG
from robots_core.plugins import ROBOT_MODELS, installed_plugins
from robots_core.wording.safety_note import NOT_CERTIFIED

CELL_OPTIONS: Final = (
    *('robot', 'drive', 'scene', 'io', 'io_map', 'rate', 'goal_tolerance', 'tool_speed_limit'),
    *('frames', 'operating_mode', 'payload', 'references', 'contact', 'orbit', 'cabin', 'guided'),
)
"""Names of the options that define a cell."""
FILES: Final = {
    'scene': 'scene with which the robot must not collide (YAML)',
    'io': 'scripted PLC to play (YAML)',
    'io_map': 'map of inputs and outputs to the topics of a PLC (YAML)',
    'frames': 'tools and bases by name (YAML); by default frames.yaml beside the program',
    'references': 'recording whose messages guide or jog the robot',
    'contact': 'what the tool touches, and force control that guides the robot there (YAML)',
    'orbit': "what the robot's base floats with in orbit: a target, a gripper, reaction wheels (YAML)",
    'cabin': 'cabin that the robot moves so that a person in it feels a vehicle (YAML)',
}
"""Options that name what is there, with what each is."""


def cell_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `cell`."""
    parser.add_argument(
        '--program', default='', help='Lua robot program to run; its header can name its robot and files'
    )
    kinds.add_namespace(parser, 'all nodes')
    _add_what_a_cell_is_made_of(parser)
    parser.add_argument(
        '--record', type=kinds.folder, metavar='FOLDER', help='record a bag below this folder'
    )
    parser.add_argument('--once', action='store_true', help='end the cell when the program has ended')
    parser.add_argument(
        '--view',
        action='store_true',
        help="serve the operator's page too; with --once: keep the pages open until Ctrl-C",
    )
    parser.add_argument(
        '--port',
        type=kinds.port,
        default=8080,
        help="first port to try for the 3D view; the operator's page is 10 above; %(default)d by default",
    )
    parser.add_argument(
        '--host',
        default='',
        metavar='ADDRESS',
        help="address of this machine at which the operator's page is served to other machines; "
        'needs --password-file; by default this machine alone has the page',
    )
    kinds.add_file(parser, '--password-file', "its first line is the password of the operator's page")
    kinds.add_file(parser, '--driver', 'driver of a real robot, in the place of simulated drives (YAML)')
    parser.add_argument(
        '--opcua',
        type=kinds.port,
        default=0,
        metavar='PORT',
        help='TCP port at which the robot is an OPC UA server, such as 4840; 0 for none',
    )
    kinds.add_file(parser, '--opcua-access', 'who may do what at the OPC UA server (YAML)')
    kinds.add_number(
        parser,
        '--watchdog',
        's',
        'time without a sign of life of a node after which the robot stops, s; 0 for no limit; '
        f'{NOT_CERTIFIED}',
        default=WATCHDOG,
        least=0.0,
    )
    parser.add_argument(
        '--debug-port',
        type=kinds.port,
        default=0,
        help='port on which editors can debug the program; 0 for none',
    )
    parser.add_argument(
        '--no-restart',
        action='store_true',
        help='end the cell when a node dies; by default the node is started again, and the robot stays still',
    )
    parser.add_argument(
        '--lockstep', action='store_true', help='run in simulated time, as fast as the nodes can'
    )
    parser.add_argument(
        '--composed',
        action='store_true',
        help='run all nodes but controller_node and drive_node in one process, in lock-step all nodes; '
        'this needs less memory, and a node that dies ends the other nodes of the process',
    )
    parser.add_argument(
        '--headless', action='store_true', help='start no 3D view of the robot, which takes processor time'
    )
    parser.add_argument('--describe', action='store_true', help='print the nodes as JSON and start none')


def simulate_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `simulate`."""
    parser.add_argument('program', help='Lua robot program to run')
    _add_what_a_cell_is_made_of(parser)
    parser.add_argument(
        '--bag', type=kinds.new_folder, metavar='FOLDER', help='write a bag; the folder must not exist'
    )
    parser.add_argument(
        '--report', type=kinds.new_file, metavar='FILE', help='write a report as one HTML page'
    )
    parser.add_argument(
        '--points',
        default='',
        metavar='FILE',
        help='file of taught points; by default the one beside the program',
    )
    text = 'longest simulated time of the program, s; %(default)g by default'
    kinds.add_number(parser, '--longest', 's', text, default=LONGEST_TIME, above=0.0)
    kinds.add_patience(parser)


def add_robot(parser: argparse.ArgumentParser, flag: str, text: str) -> None:
    """Add an argument that names a robot; a shell completes it. As an option it is '' by default."""
    action = parser.add_argument(flag, metavar='ROBOT', help=text)
    if action.option_strings:
        action.default = ''
    action.completer = _robot_names  # type: ignore[attr-defined]  # of argcomplete


def _robot_names(**_: object) -> list[str]:
    return sorted(installed_plugins(ROBOT_MODELS))


def _add_what_a_cell_is_made_of(parser: argparse.ArgumentParser) -> None:
    add_robot(parser, '--robot', 'name of the robot, or urdf:/path/to/robot.urdf')
    parser.add_argument(
        '--drive',
        default='second_order',
        choices=DRIVE_LEVELS,
        help='level of detail of the simulated drives; %(default)s by default',
    )
    for name, text in FILES.items():
        metavar = 'BAG' if name == 'references' else 'FILE'
        kinds.add_file(parser, f'--{name.replace("_", "-")}', text, metavar)
    parser.add_argument(
        '--payload',
        type=kinds.payload,
        default='0,0,0,0',
        metavar='KG,X,Y,Z',
        help='payload: mass, centre of mass in tool0 (m), optionally inertia XX,XY,XZ,YY,YZ,ZZ (kg m^2)',
    )
    text = 'rate of the references, Hz; %(default)g by default'
    kinds.add_number(parser, '--rate', 'Hz', text, default=RATE, above=0.0)
    text = 'largest error with which an axis counts as being at its target, rad'
    kinds.add_number(parser, '--goal-tolerance', 'rad', text, above=0.0)
    kinds.add_number(
        parser,
        '--tool-speed-limit',
        'm/s',
        'highest speed of the tool and of the frames of all axes on every motion; 0 for no limit; '
        f'{NOT_CERTIFIED}',
        default=0.0,
        least=0.0,
    )
    parser.add_argument(
        '--operating-mode',
        default=OperatingMode.AUTOMATIC.value,
        choices=tuple(mode.value for mode in OperatingMode),
        help='determines who may command the robot, and how fast it may move; %(default)s by default; '
        f'{NOT_CERTIFIED}',
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
