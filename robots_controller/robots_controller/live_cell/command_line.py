"""The work of `cell`: the server that its nodes are forked from loads while this process loads the rest."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from robots_controller.live_cell.processes import fork_server

if TYPE_CHECKING:  # loads beside the server
    from rich.console import Console


def start_cell(options: argparse.Namespace, console: Console) -> int:
    """Run a cell as the command line says; see `cell_command.start`."""
    if not options.describe:
        fork_server.start()
    from robots_controller.live_cell.cell_command import start  # noqa: PLC0415  # loads beside the server

    return start(options, console)
