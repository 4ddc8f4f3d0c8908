"""The cell's processes: start them, notice when one dies, stop them cleanly."""

import contextlib
import json
import os
import signal
import sys
import threading
import time
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from multiprocessing import connection, parent_process
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from setproctitle import setproctitle

from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.live_cell.node_types import node_type
from robots_controller.live_cell.processes import fork_server
from robots_core.ros.running.interrupt import end_at_once_while_loading
from robots_core.ros.running.run import run_nodes

# How long a process may take after each signal before the next, harder one, s.
STOP_SIGNALS: Final = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 2.0))
LAST_LINES: Final = 8
LAST: Final = ('io_bridge_node',)
"""Nodes that end after all others: they send the PLC the outputs that the program's node leaves."""


class NodeProcess:
    """A process of nodes, forked from a server in which the modules of all nodes are loaded.

    It leads a session of its own, so that Ctrl-C in the terminal reaches the cell alone and the cell decides
    the order in which things end. Its output goes to the file `log`.
    """

    def __init__(self, name: str, nodes: Sequence[NodeDescription], *, namespace: str, log: Path) -> None:
        self.name: Final = name
        self.nodes: Final = tuple(node.executable for node in nodes)
        self._log = log
        parts = {node.executable: node_arguments(node, namespace=namespace) for node in nodes}
        self._process: ForkServerProcess = fork_server.CONTEXT.Process(
            target=_run, args=(name, parts, log, dict(os.environ)), name=name
        )
        self._process.start()
        assert self._process.pid is not None
        self.pid: Final[int] = self._process.pid
        # The server may die before its children: what is left of them is known to the kernel alone.
        self._pidfd: int | None = None
        with contextlib.suppress(ProcessLookupError):
            self._pidfd = os.pidfd_open(self.pid)
            weakref.finalize(self, os.close, self._pidfd)

    @property
    def running(self) -> bool:
        """Whether it has not ended."""
        return not self.wait(0.0)

    @property
    def reason(self) -> str:
        """How it ended."""
        self._process.join()
        code = self._process.exitcode or 0
        return f'killed by {signal.Signals(-code).name}' if code < 0 else f'ended with exit code {code}'

    @property
    def last_lines(self) -> str:
        """The end of its output; '' if somebody has removed it."""
        with contextlib.suppress(OSError):
            return '\n'.join(self._log.read_text(errors='replace').splitlines()[-LAST_LINES:])
        return ''

    def send_signal(self, number: int) -> None:
        """Send a signal; one that has ended ignores it."""
        if self._pidfd is not None:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._pidfd, number)

    def wait(self, timeout: float) -> bool:
        """Wait at most `timeout` (s) for its end; returns whether it has ended."""
        return self._pidfd is None or bool(connection.wait([self._pidfd], timeout))


class NodeProcesses:
    """Runs the nodes of a graph in their processes; the output of each goes to `<process>.log`."""

    def __init__(self, graph: Sequence[NodeDescription], *, namespace: str, log_folder: Path) -> None:
        self._graph = tuple(graph)
        self._namespace = namespace
        self._log_folder = log_folder
        self._processes: dict[str, NodeProcess] = {}
        self._former: set[tuple[str, int]] = set()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all nodes."""
        return tuple(node.executable for node in self._graph)

    def start(self) -> None:
        """Start all nodes.

        Raises:
            RobotsError: a node's executable is not installed; then none is started.
        """
        for node in self._graph:
            node.executable_path()
        fork_server.start()
        for name in dict.fromkeys(node.process for node in self._graph):
            self.start_process(name)

    def nodes_of(self, process: str) -> tuple[str, ...]:
        """Names of the nodes in a process."""
        return tuple(node.executable for node in self._graph if node.process == process)

    def start_process(
        self, name: str, parameters: Mapping[str, Mapping[str, Any]] = MappingProxyType({})
    ) -> None:
        """Start a process, maybe again, with some parameters in the place of its nodes' own."""
        nodes = [
            replace(node, parameters={**node.parameters, **parameters.get(node.executable, {})})
            for node in self._graph
            if node.process == name
        ]
        log = self._log_folder / f'{name}.log'
        self._processes[name] = NodeProcess(name, nodes, namespace=self._namespace, log=log)

    def _process_of(self, node: str) -> NodeProcess | None:
        (name,) = (each.process for each in self._graph if each.executable == node)
        return self._processes.get(name)

    def owns(self, node: str, pid: int) -> bool:
        """A node's process is, or was, one of these."""
        return any(process.pid == pid and node in process.nodes for process in self._processes.values()) or (
            (node, pid) in self._former
        )

    def runs(self, node: str) -> bool:
        """A node's process has not ended."""
        process = self._process_of(node)
        return process is not None and process.running

    def kill(self, node: str) -> None:
        """Kill the process of a node that does nothing any more."""
        if (process := self._process_of(node)) is not None:
            process.send_signal(signal.SIGKILL)

    def take_dead(self) -> tuple[NodeProcess, ...]:
        """Processes that have ended by themselves, once each."""
        dead = [process for process in self._processes.values() if not process.running]
        for process in dead:
            self._former |= {(node, process.pid) for node in process.nodes}
            del self._processes[process.name]
        return tuple(dead)

    def stop(self) -> None:
        """End all processes, those last that write what the others leave behind."""
        processes = self._processes.values()
        _stop([process for process in processes if not set(process.nodes) <= set(LAST)])
        _stop([process for process in processes if set(process.nodes) <= set(LAST)])


def _stop(processes: Sequence[NodeProcess]) -> None:
    """Interrupt, then terminate, then kill those that are left."""
    for number, patience in STOP_SIGNALS:
        running = [process for process in processes if process.running]
        for process in running:
            process.send_signal(number)
        deadline = time.monotonic() + patience
        for process in running:
            process.wait(max(0.0, deadline - time.monotonic()))


def _run(name: str, parts: Mapping[str, Sequence[str]], log: Path, environment: Mapping[str, str]) -> None:
    """Run nodes, command lines by executable, in the process that was forked for them."""
    os.setsid()
    title = next(iter(parts.values()))[0] if len(parts) == 1 else name
    # While the environment is where the process began with it; ROS names its log file by the title.
    setproctitle(title)
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open('ab') as output:  # after what an earlier process left
        for stream in (sys.stdout, sys.stderr):
            os.dup2(output.fileno(), stream.fileno())
    sys.stdout = os.fdopen(sys.stdout.fileno(), 'w', buffering=1)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = [title]
    threading.Thread(target=_end_with_cell, name='cell', daemon=True).start()
    end_at_once_while_loading()
    sys.exit(
        run_nodes(
            [
                partial(node_type(executable), cli_args=arguments[1:], use_global_arguments=False)
                for executable, arguments in parts.items()
            ]
        )
    )


def _end_with_cell() -> None:
    """End this node when the cell's own process has died, which would have ended it."""
    cell = parent_process()
    assert cell is not None
    cell.join()
    os.kill(os.getpid(), signal.SIGTERM)


def node_arguments(node: NodeDescription, *, namespace: str) -> list[str]:
    """The command line of a node.

    Raises:
        RobotsError: its executable is not installed.
    """
    arguments = [str(node.executable_path()), '--ros-args', '-r', f'__ns:={namespace}']
    for name, value in node.parameters.items():
        arguments += ['-p', f'{name}:={json.dumps(value, ensure_ascii=False)}']  # which is YAML
    return arguments
