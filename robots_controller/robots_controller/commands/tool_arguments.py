"""What the commands for programs, bags and robots take."""

import argparse
from pathlib import Path
from typing import Final

from robots_controller.commands import value_kinds as kinds
from robots_controller.commands.cell_arguments import FILES, add_robot
from robots_controller.defaults import ANALOG_SIZE, DIGITAL_SIZE, LONGEST_WALK, MOST_COMBINATIONS

HALF_AXES: Final = ('x', 'y', 'z', '-x', '-y', '-z')


def check_program_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `check_program`."""
    parser.add_argument('programs', nargs='+', metavar='PROGRAM', help='Lua files')
    add_robot(
        parser, '--robot', 'robot to check the programs for; by default the one that each program names'
    )
    for kind, size in (('digital', DIGITAL_SIZE), ('analog', ANALOG_SIZE)):
        text = f'number of {kind} inputs and outputs; %(default)d by default'
        kinds.add_count(parser, f'--{kind}', text, default=size)
    parser.add_argument('--walk', action='store_true', help='simulate the programs too')
    kinds.add_file(parser, '--scene', 'simulate, with this scene (YAML)')
    kinds.add_file(parser, '--io', 'simulate, with all combinations of the inputs of this PLC script (YAML)')
    kinds.add_file(parser, '--io-map', FILES['io_map'])
    kinds.add_file(parser, '--frames', FILES['frames'])
    text = 'largest number of combinations to simulate; %(default)d by default'
    kinds.add_count(parser, '--combinations', text, default=MOST_COMBINATIONS, least=1)
    text = 'longest simulated time of a combination, s; %(default)g by default'
    kinds.add_number(parser, '--longest', 's', text, default=LONGEST_WALK, above=0.0)
    kinds.add_patience(parser)


def report_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `report`."""
    parser.add_argument('bag', type=kinds.bag, metavar='BAG', help='a recorded bag, live or simulated')
    parser.add_argument(
        'other', type=kinds.bag, nargs='?', metavar='BAG', help='a second bag, to compare with the first'
    )
    parser.add_argument('-o', '--output', type=kinds.new_file, metavar='FILE', help='write an HTML page')
    add_robot(parser, '--robot', 'name of the robot; by default the one that the bag names')
    kinds.add_file(parser, '--scene', 'scene around the robot, for distances (YAML)')
    kinds.add_namespace(parser, 'the recorded cell')


def study_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `study`."""
    kinds.add_file(parser, 'study', 'YAML file with the grid')
    parser.add_argument(
        '-o',
        '--output',
        type=kinds.folder,
        metavar='FOLDER',
        help='folder for the results; out/<name of the file> by default',
    )
    parser.add_argument(
        '--scheduler',
        default='',
        metavar='ADDRESS',
        help='run on the workers of the Dask scheduler at this address',
    )
    text = 'number of processes on this machine; 0, the default, is one for each core'
    kinds.add_count(parser, '--workers', text, default=0)


def check_bag_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `check_bag`."""
    parser.add_argument(
        'recorded', type=kinds.bag, metavar='BAG', help='the bag to check: a folder, or a .mcap or .db3 file'
    )
    parser.add_argument(
        '--against', type=kinds.bag, required=True, metavar='BAG', help='the bag that is expected'
    )
    kinds.add_file(parser, '--tolerances', 'tolerances (YAML); by default all values must be equal')
    parser.add_argument('--junit', type=kinds.new_file, metavar='FILE', help='write the result as JUnit XML')
    parser.add_argument('--partial', action='store_true', help='accept a recorded bag that was cut off')


def replay_bag_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `replay_bag`, without those of ROS."""
    parser.add_argument('bag', type=kinds.bag, metavar='BAG', help='a folder, or a .mcap or .db3 file')
    parser.add_argument(
        '--rate',
        type=kinds.number('times the recorded speed', above=0.0),
        default=1.0,
        metavar='TIMES',
        help='speed relative to the recording; %(default)g by default',
    )
    text = 'time after the first message at which to begin, s'
    kinds.add_number(parser, '--start', 's', text, default=0.0, least=0.0)
    parser.add_argument('--topics', nargs='+', default=(), help='publish only these topics')
    parser.add_argument(
        '--remap', nargs='+', default=(), metavar='FROM:=TO', help='publish topics under other names'
    )
    text = 'longest wait for subscribers, s; %(default)g by default'
    kinds.add_number(parser, '--wait', 's', text, default=1.0, least=0.0)
    parser.add_argument('--ros-args', nargs=argparse.REMAINDER, default=(), help='arguments of ROS follow')


def lua_meta_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `lua_meta`."""
    add_robot(parser, '--robot', 'robot for whose number of axes to write the help; any by default')


def show_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `robots show`."""
    add_robot(parser, 'robot', 'name of a robot, or urdf:/path/to/robot.urdf')


def check_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `robots check`."""
    parser.add_argument(
        'robot', metavar='FILE.urdf', help='URDF or xacro file; options may follow, as in file.urdf?tip=hand'
    )


def explain_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `robots explain`."""
    parser.add_argument('code', metavar='CODE', help='code at the end of an error, such as R101')


def measure_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `robots measure`, which has one command for each thing that it measures."""
    what = parser.add_subparsers(
        dest='what', required=True, metavar='tool|base|payload', parser_class=type(parser)
    )
    tool = what.add_parser('tool', help='from 4 points or more, and 2 for its orientation')
    _add_points_file(tool)
    tool.add_argument(
        '--points',
        nargs='+',
        default=(),
        metavar='NAME',
        help='points that touch the fixed tip; all by default',
    )
    tool.add_argument(
        '--orientation',
        nargs=2,
        metavar='NAME',
        help='point with the fixed tip on an axis of the tool, and one with it in a plane of that axis',
    )
    tool.add_argument(
        '--axis',
        choices=HALF_AXES,
        default='-z',
        help='half axis of the tool that the first point of --orientation is on; %(default)s by default',
    )
    base = what.add_parser('base', help='from its origin, a point on its x axis and one in its xy plane')
    _add_points_file(base)
    base.add_argument(
        '--points', nargs=3, required=True, metavar='NAME', help='origin, on the x axis, in the xy plane'
    )
    base.add_argument(
        '--tool',
        default='',
        metavar='NAME',
        help='tool of the frames file that has touched them; the flange by default',
    )
    payload = what.add_parser('payload', help='from the torques of a recorded motion')
    payload.add_argument('file', type=kinds.bag, metavar='BAG', help='a recorded bag, live or simulated')
    add_robot(payload, '--robot', 'name of the robot; by default the one that the bag names')
    kinds.add_namespace(payload, 'the recorded cell')
    for one, beside in ((tool, 'beside the points'), (base, 'beside the points'), (payload, 'here')):
        one.add_argument('--name', default='', help='save the result under this name')
        one.add_argument(
            '--frames',
            type=kinds.new_file,
            metavar='FILE',
            help=f'file with tools and bases by name (YAML); by default frames.yaml {beside}',
        )
        one.add_argument(
            '--json', action='store_true', default=argparse.SUPPRESS, help='print JSON in the place of tables'
        )


def _add_points_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('file', type=Path, metavar='FILE', help='taught points, such as program.points.yaml')
    add_robot(parser, '--robot', 'name of the robot; by default the one that the program of the points names')
