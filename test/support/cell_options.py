"""Options of the command `cell`, and the nodes that follow from them."""

from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from robots_controller.commands.command_table import CELL
from robots_controller.live_cell.cell_command import complete_options
from robots_controller.live_cell.cell_graph import NodeDescription, cell_graph


def parse_options(arguments: Sequence[str]) -> Namespace:
    """Options from a command line, and from its program."""
    return complete_options(CELL.parse(arguments))


def nodes_of_cell(**options: Any) -> tuple[NodeDescription, ...]:
    """The nodes of a cell with these options, all others at their defaults."""
    defaults = vars(CELL.parse([])) | {'pendant': False, 'debug_token': ''}
    return cell_graph(Namespace(**defaults | options))
