"""What `robots measure` takes."""

import argparse
from pathlib import Path
from typing import Final

from robots_controller.commands import value_kinds as kinds
from robots_controller.commands.cell_arguments import add_robot

HALF_AXES: Final = ('x', 'y', 'z', '-x', '-y', '-z')


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
