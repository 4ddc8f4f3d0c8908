"""Where the nodes of a trial live: in `cell`, or on their own as the launch file starts them."""

import os
import signal
import subprocess
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, Self

from cell_options import nodes_of_cell
from node_pids import node_pids
from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.live_cell.processes.node_processes import node_arguments
from robots_controller.live_cell.processes.node_restarts import MOST_DEATHS, STEADY
from robots_controller.program.files.program_header import read_program_header

PROGRAMS: Final = Path(__file__).parent / 'programs'
IO_MAP: Final = PROGRAMS / 'outputs.yaml'
END_TIME: Final = 15.0  # s
POLL: Final = 0.1  # s


class Surroundings(ABC):
    """The processes of a cell with one program; a context manager.

    Args:
        program: Its program.
        environment: Of the processes.
        log: Folder of their output.
        io_map: What the PLC gets and sends.
        options: Further ones of `cell`.
    """

    name: str

    def __init__(
        self,
        program: Path,
        environment: Mapping[str, str],
        log: Path,
        *,
        io_map: Path = IO_MAP,
        options: Sequence[str] = (),
    ) -> None:
        header = read_program_header(program)
        files = {'scene': header.scene, 'io': header.io, 'program': str(program), 'io_map': str(io_map)}
        self.robot = header.robot
        self.graph = nodes_of_cell(robot=header.robot, describe=True, port=0, **files)
        self._environment = {**os.environ, **environment}
        self._log = log
        self._log.mkdir(parents=True, exist_ok=True)
        self._program, self._io_map, self._options = program, io_map, options

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    @property
    def nodes(self) -> tuple[str, ...]:
        """Names of all nodes."""
        return tuple(node.executable for node in self.graph)

    @abstractmethod
    def start(self) -> None:
        """Start all processes."""

    @abstractmethod
    def pid(self, node: str) -> int | None:
        """The process of a node; None while it has none."""

    @abstractmethod
    def wait_until_killable(self, node: str) -> None:
        """Wait until one more death of the node is nothing unusual."""

    @abstractmethod
    def bring_back(self, node: str) -> None:
        """Start a node again that was killed, if nothing else does."""

    @abstractmethod
    def end(self) -> None:
        """End all processes."""


class InCell(Surroundings):
    """In `cell`, which starts dead nodes again."""

    name = 'cell'

    def start(self) -> None:
        """Start the cell."""
        command = str(NodeDescription('robots_controller', 'cell').executable_path())
        options = [
            '--program',
            str(self._program),
            '--io-map',
            str(self._io_map),
            '--port',
            '0',
            *self._options,
        ]
        self._output = (self._log / 'cell.log').open('wb')
        self._process = subprocess.Popen(
            [command, *options],
            env={**self._environment, 'PYTHONUNBUFFERED': '1'},
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            cwd=self._log,
        )
        self._deaths: dict[str, list[float]] = {}

    @property
    def output(self) -> str:
        """What the cell has printed."""
        return (self._log / 'cell.log').read_text(errors='replace')

    @property
    def cell_pid(self) -> int | None:
        """The process of the cell itself; None when it has ended."""
        return self._process.pid if self._process.poll() is None else None

    def pid(self, node: str) -> int | None:
        """The process of a node."""
        return node_pids(self._process.pid).get(node)

    def wait_until_killable(self, node: str) -> None:
        """A node that dies again and again within a minute is not started any more."""
        deaths = self._deaths.setdefault(node, [])
        while len(deaths) >= MOST_DEATHS - 2 and time.monotonic() < deaths[-1] + STEADY + 10.0:
            time.sleep(POLL)
        if deaths and time.monotonic() > deaths[-1] + STEADY + 10.0:
            deaths.clear()
        deaths.append(time.monotonic())

    def bring_back(self, node: str) -> None:
        """The cell does."""

    def end(self) -> None:
        """As Ctrl-C does."""
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(END_TIME)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._output.close()


class Launched(Surroundings):
    """On their own, with the parameters that the launch file gives them: dead nodes are not started again."""

    name = 'launch'

    def start(self) -> None:
        """Start all nodes."""
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        for node in self.graph:
            self.bring_back(node.executable)

    def pid(self, node: str) -> int | None:
        """The process of a node."""
        process = self._processes[node]
        return process.pid if process.poll() is None else None

    def wait_until_killable(self, node: str) -> None:
        """It is at any time."""

    def bring_back(self, node: str) -> None:
        """Start a node, as a supervisor would."""
        (description,) = (each for each in self.graph if each.executable == node)
        if node in self._processes:
            self._processes[node].wait(END_TIME)
        with (self._log / f'{node}.log').open('ab') as output:
            self._processes[node] = subprocess.Popen(
                node_arguments(description, namespace='/'),
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                cwd=self._log,
            )

    def end(self) -> None:
        """Interrupt all, and kill those that do not end by that."""
        for number, patience in (
            (signal.SIGCONT, 0.0),
            (signal.SIGINT, END_TIME),
            (signal.SIGKILL, 1.0),
        ):
            running = [process for process in self._processes.values() if process.poll() is None]
            for process in running:
                process.send_signal(number)
            deadline = time.monotonic() + patience
            while patience and time.monotonic() < deadline and any(p.poll() is None for p in running):
                time.sleep(POLL)


SURROUNDINGS: Final = (InCell, Launched)
