"""composed_nodes: several nodes in one process, with the parameters of all of them."""

import argparse
import sys

from rclpy.utilities import remove_ros_args

from robots_controller.live_cell.node_types import node_type
from robots_core.errors import RobotsError
from robots_core.exit_codes import ExitCode
from robots_core.ros.running.run import run_nodes


def main() -> int:
    """Run from the command line; returns the exit code, see `run_nodes`."""
    parser = argparse.ArgumentParser(prog='composed_nodes', description=__doc__)
    parser.add_argument('nodes', nargs='+', metavar='NODE', help='executable of a node, as planning_node')
    options = parser.parse_args(remove_ros_args(sys.argv)[1:])
    try:
        nodes = [node_type(name) for name in options.nodes]
    except RobotsError as error:
        print(error.line_for_person, file=sys.stderr)
        return ExitCode.BAD_INPUT
    return run_nodes(nodes)
