"""A node as a user has it: a process of its own."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator

from robots_controller.live_cell.cell_graph import NodeDescription

END_TIME = 240.0  # s, on a slow and busy machine


@contextlib.contextmanager
def node_process(package: str, name: str, **parameters: object) -> Iterator[None]:
    """Run a node for a while; Ctrl-C ends it, without a list of what was left.

    Args:
        package: The package that has it.
        name: The node's name, also of its executable.
        parameters: Its ROS parameters.
    """
    command = [str(NodeDescription(package, name).executable_path()), '--ros-args']
    for parameter, value in parameters.items():
        command += ['-p', f'{parameter}:={value}']
    with tempfile.TemporaryFile('w+') as said:
        process = subprocess.Popen(command, stderr=said, start_new_session=True)
        try:
            yield
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(END_TIME)
            said.seek(0)
            text = said.read()
            print(text, file=sys.stderr)
        assert 'nanobind' not in text
