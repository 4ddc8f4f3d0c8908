"""The cell's processes: start them, notice when one dies, stop them cleanly."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robots_controller.live_cell.cell_graph import NodeDescription

# How long a process may take after each signal before the next, harder one, s.
STOP_SIGNALS = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 2.0))
LAST_LINES = 8


@dataclass(frozen=True)
class DeadNode:
    """A node that ended by itself.

    Attributes:
        name: The node.
        reason: Exit code or signal.
        last_words: The end of its output.
    """

    name: str
    reason: str
    last_words: str


class NodeProcesses:
    """Runs each node of a graph as its own process.

    Each process is the leader of its own session, so that Ctrl-C in the terminal reaches the cell alone
    and the cell decides the order in which things end.

    Args:
        graph: The nodes.
        namespace: ROS namespace of all of them.
        log_folder: Each node's output goes to `<node>.log` in it.
    """

    def __init__(self, graph: Sequence[NodeDescription], *, namespace: str, log_folder: Path) -> None:
        self._graph = tuple(graph)
        self._namespace = namespace
        self._log_folder = log_folder
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all nodes."""
        return tuple(node.name for node in self._graph)

    def start(self) -> None:
        """Start all nodes.

        Raises:
            RobotsError: a node's executable is not installed; then none is started.
        """
        commands = {node.name: self._command(node) for node in self._graph}
        self._log_folder.mkdir(parents=True, exist_ok=True)
        for name, command in commands.items():
            with self._log(name).open('wb') as log:
                self._processes[name] = subprocess.Popen(  # noqa: S603  # our own executables
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                    env={**os.environ, 'PYTHONUNBUFFERED': '1'},
                )

    def _command(self, node: NodeDescription) -> list[str]:
        command = [str(node.executable_path()), '--ros-args', '-r', f'__ns:={self._namespace}']
        for name, value in node.parameters.items():
            command += ['-p', f'{name}:={_yaml(value)}']
        return command

    def _log(self, name: str) -> Path:
        return self._log_folder / f'{name}.log'

    def pid(self, name: str) -> int:
        """Process id of a node; -1 if it is none of these."""
        process = self._processes.get(name)
        return -1 if process is None else process.pid

    def dead(self) -> tuple[DeadNode, ...]:
        """Nodes that have ended by themselves."""
        return tuple(
            DeadNode(name, _reason(process.returncode), self.last_words(name))
            for name, process in self._processes.items()
            if process.poll() is not None
        )

    def last_words(self, name: str) -> str:
        """The last lines of a node's output."""
        lines = self._log(name).read_text(errors='replace').splitlines()
        return '\n'.join(lines[-LAST_LINES:])

    def stop(self) -> None:
        """End all processes: interrupt, then terminate, then kill those that are left."""
        for number, patience in STOP_SIGNALS:
            running = [process for process in self._processes.values() if process.poll() is None]
            if not running:
                return
            for process in running:
                process.send_signal(number)
            deadline = time.monotonic() + patience
            for process in running:
                try:
                    process.wait(max(0.0, deadline - time.monotonic()))
                except subprocess.TimeoutExpired:
                    continue


def _yaml(value: Any) -> str:
    if isinstance(value, bool):
        return 'true' if value else 'false'
    if isinstance(value, str):
        escaped = value.replace('\\', '\\\\').replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, float):
        return repr(value)
    return str(value)


def _reason(returncode: int) -> str:
    if returncode < 0:
        return f'killed by {signal.Signals(-returncode).name}'
    return f'ended with exit code {returncode}'
