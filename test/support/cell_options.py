"""Options of the commands `cell` and `simulate`, and the nodes that follow from them."""

from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from robots_controller.commands.command_table import CELL, SIMULATE
from robots_controller.live_cell.cell_command import complete_options
from robots_controller.live_cell.cell_graph import NodeDescription, cell_graph
from robots_controller.simulation import command_line


def parse_options(arguments: Sequence[str]) -> Namespace:
    """Options of `cell` from a command line, and from its program."""
    return complete_options(CELL.parser().parse_all(arguments))


def simulate_options(arguments: Sequence[str]) -> Namespace:
    """The same of `simulate`."""
    return command_line.complete_options(SIMULATE.parser().parse_all(arguments))


def nodes_of_cell(**options: Any) -> tuple[NodeDescription, ...]:
    """The nodes of a cell with these options, all others at their defaults."""
    defaults = vars(CELL.parser().parse_all([])) | {'pendant': False, 'debug_token': ''}
    return cell_graph(Namespace(**defaults | options))
