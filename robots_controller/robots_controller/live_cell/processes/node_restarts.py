"""NodeRestarts: starts processes of a cell again that have died or are frozen; nothing moves by that."""

import time
from collections.abc import Iterable, Mapping
from typing import Any, Final

from rclpy.node import Node
from rich.console import Console
from rich.markup import escape
from std_msgs.msg import UInt64

from robots_controller.io.fail_safe import FailSafe, fail_safe_texts, safe_value
from robots_controller.io.io_image import Channel, Kind
from robots_controller.live_cell.cell_events import ProgramStatus
from robots_controller.live_cell.cell_monitor import CellMonitor
from robots_controller.live_cell.processes.node_processes import NodeProcess, NodeProcesses
from robots_core.periodic.realtime import processor_share
from robots_core.periodic.watchdog import LONGEST, Watchdog
from robots_core.ros.peers.heartbeat import HEARTBEAT
from robots_core.ros.qos import make_publisher
from robots_core.ros.streams.polled_subscription import PolledSubscription

PATIENCE: Final = 10.0
"""Silence of so many times `watchdog`, which has stopped the robot long before, is no hold-up any more."""
FIRST_DELAY: Final = 0.5  # s
LONGEST_DELAY: Final = 30.0  # s
MOST_DEATHS: Final = 6
"""In a row: one more restart would not help either."""
STEADY: Final = 60.0
"""A node that has lived for so long starts a new row, s."""
PROGRAM_NODE: Final = 'lua_program_node'
UNDER_WAY: Final = ('RUNNING', 'PAUSED')


class FrozenNodes:
    """Notices nodes that have given no sign of life for long; with a watchdog of 0 s, none."""

    def __init__(self, monitor: CellMonitor, names: Iterable[str], watchdog: float) -> None:
        self.timeout = min(PATIENCE * watchdog, LONGEST)
        """Silence of a node that is frozen, s."""
        self._beats = {
            name: PolledSubscription(monitor, UInt64, f'{name}/{HEARTBEAT}', raw=True)
            for name in (names if watchdog else ())
        }
        self._watchdogs: dict[str, Watchdog] = {}

    def started(self, name: str) -> None:
        """A node is restarted: its silence counts from its first sign of life on."""
        self._watchdogs.pop(name, None)

    def check(self, now: float) -> list[str]:
        """The nodes that are frozen since the last check, now in s."""
        found = []
        for name, beats in self._beats.items():
            watchdog = self._watchdogs.setdefault(name, Watchdog(self.timeout, processor_share))
            if watchdog.check(now, alive=beats.take() is not None):
                found.append(name)
        return found


class OrphanedOutputs:
    """Writes the images of outputs while the node that owns them is dead, and never beside it."""

    def __init__(self, node: Node, fail_safe: FailSafe) -> None:
        self._node, self._fail_safe = node, fail_safe
        self._publishers: list[Any] = []
        self._values: dict[str, float] = {}

    def take_over(self, images: Mapping[Kind, Any]) -> None:
        """The owner is dead: publish its last images with fail-safe values."""
        self._values = {}
        for kind, image in images.items():
            outputs = [Channel(kind, 'output', index) for index in range(1, len(image.data) + 1)]
            values = [
                safe_value(self._fail_safe, output, float(value))
                for output, value in zip(outputs, image.data, strict=True)
            ]
            self._values |= {output.name: value for output, value in zip(outputs, values, strict=True)}
            data = [int(value) for value in values] if kind == 'digital' else values
            publisher = make_publisher(self._node, type(image), f'{kind}_outputs')
            publisher.publish(type(image)(layout=image.layout, data=data))
            self._publishers.append(publisher)

    def hand_back(self) -> list[str]:
        """Publish no more; returns the values that are not 0, as a parameter of the owner's next process."""
        for publisher in self._publishers:
            self._node.destroy_publisher(publisher)
        self._publishers.clear()
        return fail_safe_texts({name: value for name, value in self._values.items() if value != 0.0})


class RestartPolicy:
    """Each death in a row doubles the delay of the next start, until there are too many."""

    def __init__(self) -> None:
        self._deaths: dict[str, int] = {}  # in a row
        self._started: dict[str, float] = {}  # s
        self._due: dict[str, float] = {}

    def died(self, node: str, now: float) -> float | None:
        """A node has died: the delay until it is started again, s; None to give it up."""
        steady = now - self._started.get(node, 0.0) >= STEADY
        deaths = self._deaths[node] = 1 if steady else self._deaths.get(node, 0) + 1
        if deaths >= MOST_DEATHS:
            return None
        delay = min(FIRST_DELAY * 2.0 ** (deaths - 1), LONGEST_DELAY)
        self._due[node] = now + delay
        return delay

    def due(self, now: float) -> list[str]:
        """The nodes to start now, once each."""
        found = [node for node, time in self._due.items() if time <= now]
        for node in found:
            del self._due[node]
            self._started[node] = now
        return found


class NodeRestarts:
    """Restarts by a policy, and keeps what the program's node leaves: outputs, and where the program was."""

    def __init__(
        self,
        processes: NodeProcesses,
        monitor: CellMonitor,
        console: Console,
        *,
        fail_safe: FailSafe,
        restarting: bool,
    ) -> None:
        self._processes, self._monitor, self._console = processes, monitor, console
        self._outputs = OrphanedOutputs(monitor, fail_safe)
        self._policy = RestartPolicy() if restarting else None
        self._program = ProgramStatus('', '', 0, '', '')
        self._reasons: dict[str, str] = {}  # by node

    def program_reported(self, status: ProgramStatus) -> None:
        """The program's node has reported its place in the program."""
        self._program = status

    def died(self, process: NodeProcess) -> bool:
        """A process has died; returns whether it will be started again."""
        name = process.name
        self._reasons |= dict.fromkeys(process.nodes, f'{name} {process.reason}')
        if PROGRAM_NODE in process.nodes:
            self._outputs.take_over(self._monitor.outputs)
        if self._policy is None:
            return False
        delay = self._policy.died(name, time.monotonic())
        if delay is None:
            self._console.print(f'[bold red]{name} dies again and again[/]: it is not started any more')
            return False
        self._console.print(f'[yellow]{name} is started again in {delay:g} s[/]')
        return True

    def start_due(self) -> list[str]:
        """Start the processes whose time has come; returns the names of their nodes."""
        due = [] if self._policy is None else self._policy.due(time.monotonic())
        started: list[str] = []
        for name in due:
            nodes = self._processes.nodes_of(name)
            self._processes.start_process(name, {node: self._parameters(node) for node in nodes})
            started += nodes
        return started

    def _parameters(self, name: str) -> dict[str, Any]:
        """What the next process of a node continues from."""
        match name:
            case 'lua_program_node':
                return self._of_program()
            case 'controller_node':
                return {'interrupted': self._reasons[name]}
            case _:
                return {}

    def _of_program(self) -> dict[str, Any]:
        program, interrupted = self._program, ''
        if program.state in UNDER_WAY:
            interrupted = (
                f'{program.file} was interrupted at line {program.line}: {self._reasons[PROGRAM_NODE]}'
            )
            self._console.print(f'[bold red]{escape(interrupted)}[/]')
        elif program.state == 'OPENED':  # the report of an earlier interruption stands
            interrupted = program.error
        return {'interrupted': interrupted, 'outputs': self._outputs.hand_back() or ['']}
