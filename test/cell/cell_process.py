"""A whole cell as its user starts it: its options, its output, its end."""

from __future__ import annotations

import contextlib
import ctypes
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from ipaddress import ip_address
from pathlib import Path
from typing import TextIO, cast

from rich.console import Console

from cell_options import parse_options
from node_pids import node_pids
from robots_controller.live_cell.cell_command import run_cell
from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.live_cell.processes import fork_server

# s, on a slow machine that is busy with other things.
DEADLINE = 480.0
# On such a machine a process may be held up for seconds.
PATIENT = ('--watchdog', '10')


class CellOutput:
    """The output of a cell, read line by line while it runs.

    Args:
        out: Folder of its recordings.
    """

    def __init__(self, out: Path) -> None:
        self.out = out
        self.lines: list[str] = []
        self._queue: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    @property
    def text(self) -> str:
        return '\n'.join(self.lines)

    @property
    def bag(self) -> Path:
        return next(self.out.glob('*/bag'))

    @property
    def logs(self) -> str:
        """What the nodes have written."""
        return ''.join(file.read_text() for file in self.out.glob('*/log/*.log'))

    def until(self, *texts: str) -> None:
        """Read on until each text has been in a line, in any order."""
        deadline, missing = time.monotonic() + DEADLINE, set(texts)
        while missing:
            line = self._queue.get(timeout=max(0.0, deadline - time.monotonic()))
            assert line is not None, f'cell ended before {missing}:\n{self.text}'
            self.lines.append(line)
            missing = {text for text in missing if text not in line}

    def until_ready(self) -> None:
        """Read on until all nodes are ready, and the recorder: a node that dies before ends the cell."""
        self.until('the cell is ready')

    def _until_end(self) -> None:
        deadline = time.monotonic() + DEADLINE
        while (line := self._queue.get(timeout=max(0.0, deadline - time.monotonic()))) is not None:
            self.lines.append(line)


class CellThread(CellOutput):
    """`cell` in a thread of this process: its nodes are forked from the server of all tests.

    Args:
        options: Of the command.
        out: Folder of its recordings.
    """

    def __init__(self, *options: str, out: Path) -> None:
        super().__init__(out)
        self._line, self._code = '', -1
        self._options = parse_options([*PATIENT, *options, '--record', str(out)])
        fork_server.start()
        self._thread = threading.Thread(target=self._run, name='cell')
        self._thread.start()

    def _run(self) -> None:
        try:
            console = Console(file=cast('TextIO', self), highlight=False, soft_wrap=True)
            self._code = run_cell(self._options, console)
        finally:
            self._queue.put(None)

    def write(self, text: str) -> None:
        """For the console."""
        *lines, self._line = (self._line + text).split('\n')
        for line in lines:
            self._queue.put(line)

    def flush(self) -> None:
        """For the console."""

    def interrupt(self) -> None:
        """As Ctrl-C does in the main thread of a process."""
        assert self._thread.ident is not None
        interrupt = ctypes.py_object(KeyboardInterrupt)
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self._thread.ident), interrupt)

    def wait(self) -> int:
        """Read to the end; returns the exit code."""
        self._until_end()
        self._thread.join()
        return self._code

    def close(self) -> None:
        if self._thread.is_alive():
            self.interrupt()
            self._thread.join()

    def node_pids(self) -> dict[str, int]:
        """Process ids of the running nodes."""
        return node_pids(os.getpid())


class CellProcess(CellOutput):
    """`cell` started with some options as a process of its own."""

    def __init__(self, *options: str, out: Path) -> None:
        super().__init__(out)
        command = [str(NodeDescription('robots_controller', 'cell').executable_path()), *PATIENT, *options]
        self.process = subprocess.Popen(
            [*command, '--record', str(out)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, 'PYTHONUNBUFFERED': '1'},
        )
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._queue.put(line.rstrip('\n'))
        self._queue.put(None)

    def interrupt(self) -> None:
        self.process.send_signal(signal.SIGINT)

    def wait(self) -> int:
        """Read to the end; returns the exit code."""
        self._until_end()
        return self.process.wait(DEADLINE)

    def close(self) -> None:
        if self.process.poll() is None:
            self.interrupt()
            try:
                self.process.wait(DEADLINE)
            except subprocess.TimeoutExpired:
                self.process.kill()

    def udp_addresses(self, pid: int) -> set[str]:
        """Addresses at which a process receives datagrams."""
        sockets = set()
        for entry in Path(f'/proc/{pid}/fd').iterdir():
            with contextlib.suppress(FileNotFoundError):  # closed meanwhile
                sockets.add(entry.readlink().name)
        rows = [line.split() for line in Path(f'/proc/{pid}/net/udp').read_text().splitlines()[1:]]
        return {
            str(ip_address(int.from_bytes(bytes.fromhex(row[1].split(':')[0]), sys.byteorder)))
            for row in rows
            if f'socket:[{row[9]}]' in sockets
        }

    def node_pids(self) -> dict[str, int]:
        """Process ids of the running nodes, forked from the server that the cell has started."""
        return node_pids(self.process.pid)
