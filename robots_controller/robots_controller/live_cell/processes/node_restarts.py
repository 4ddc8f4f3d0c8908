"""NodeRestarts: starts processes of a cell again that have died; nothing moves by that."""

import time
from typing import Any, Final

from rich.console import Console
from rich.markup import escape

from robots_controller.io.fail_safe import FailSafe
from robots_controller.live_cell.cell_events import ProgramStatus
from robots_controller.live_cell.cell_monitor import CellMonitor
from robots_controller.live_cell.processes.node_processes import NodeProcess, NodeProcesses
from robots_controller.live_cell.processes.orphaned_outputs import OrphanedOutputs
from robots_controller.live_cell.processes.restart_policy import RestartPolicy

PROGRAM_NODE: Final = 'lua_program_node'
UNDER_WAY: Final = ('RUNNING', 'PAUSED')


class NodeRestarts:
    """Restarts by a policy, and keeps what the program's node leaves: its outputs, and where the program was.

    Args:
        processes: The nodes.
        monitor: Listens to them.
        console: Where restarts are reported.
        fail_safe: Values of outputs that are written while the program's node is dead.
        restarting: Nodes are started again.
    """

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
