"""A whole cell as its user starts it: one command, its output, its end."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from ipaddress import ip_address
from pathlib import Path

from node_pids import node_pids
from robots_controller.live_cell.cell_graph import NodeDescription

# s, on a slow machine that is busy with other things.
DEADLINE = 480.0
# On such a machine a process may be held up for seconds.
PATIENT = ('--watchdog', '10')


class CellProcess:
    """`cell` started with some options; its output is read line by line."""

    def __init__(self, *options: str, out: Path) -> None:
        self.out = out
        command = [str(NodeDescription('robots_controller', 'cell').executable_path()), *PATIENT, *options]
        self.process = subprocess.Popen(
            [*command, '--record', str(out)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, 'PYTHONUNBUFFERED': '1'},
        )
        self.lines: list[str] = []
        self._queue: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._queue.put(line.rstrip('\n'))
        self._queue.put(None)

    @property
    def text(self) -> str:
        return '\n'.join(self.lines)

    @property
    def bag(self) -> Path:
        return next(self.out.glob('*/bag'))

    def until(self, text: str) -> str:
        """Read on until a line holds `text`; returns that line."""
        deadline = time.monotonic() + DEADLINE
        while True:
            line = self._queue.get(timeout=max(0.0, deadline - time.monotonic()))
            assert line is not None, f'cell ended before {text!r}:\n{self.text}'
            self.lines.append(line)
            if text in line:
                return line

    def until_ready(self) -> None:
        """Read on until all nodes are ready, and the recorder: a node that dies before ends the cell."""
        self.until('the cell is ready')

    def interrupt(self) -> None:
        self.process.send_signal(signal.SIGINT)

    def wait(self) -> int:
        """Read to the end; returns the exit code."""
        deadline = time.monotonic() + DEADLINE
        while (line := self._queue.get(timeout=max(0.0, deadline - time.monotonic()))) is not None:
            self.lines.append(line)
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
