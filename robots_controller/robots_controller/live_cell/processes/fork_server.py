"""The process that the nodes of a cell are forked from: it has loaded, once, what all of them are made of.

Imports and compiled code make up most of a node's start and most of its memory; forked nodes share both.
This module imports nothing of the suite, so that the server loads while the rest of `cell` loads too.
"""

import multiprocessing
import os
from multiprocessing import forkserver
from typing import Final

CONTEXT: Final = multiprocessing.get_context('forkserver')
"""Its processes are forked from the server."""


def start() -> None:
    """Start the server, unless it runs; it loads while this process continues."""
    # A fork keeps no threads, and those of a linear algebra library do not help matrices of this size.
    os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')
    CONTEXT.set_forkserver_preload(
        [f'robots_controller.live_cell.processes.{name}' for name in ('parent_end', 'loaded_nodes')]
    )
    forkserver.ensure_running()
