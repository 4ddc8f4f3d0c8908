"""CellListener: the nodes of the process `cell` itself."""

import contextlib
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from robots_controller.live_cell.cell_monitor import CellMonitor, TriggerClients
from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_core.process_end import bounded_end
from robots_core.ros.lockstep.agenda import LockstepError
from robots_core.ros.lockstep.coordinator import PATIENCE, Coordinator
from robots_core.ros.running.spun_nodes import SpunNodes
from robots_core.ros.timed_node import TimedNode

# The thread that advances time waits so long at most for those that listen and record.
SWITCH_INTERVAL = 1e-4  # s
POLL = 0.01  # s


@dataclass
class CellListener:
    """What listens to a cell, records it, and advances the time of a lock-step run.

    Attributes:
        monitor: Gives the events.
        recorder: Writes the bag; None for none.
        held: A lock-step run has done all that was due at its first instant.
        problem: Why a lock-step run cannot continue; '' if it can.
    """

    monitor: CellMonitor
    recorder: BagRecorder | None
    held: bool = False
    problem: str = ''
    _coordinator: Coordinator | None = None
    _triggers: TriggerClients | None = None
    _spinning: SpunNodes | None = None

    def coordinate(self, nodes: Iterable[str]) -> None:
        """Begin a lock-step run of nodes as soon as all have joined, and hold it at its first instant."""
        sys.setswitchinterval(SWITCH_INTERVAL)
        node = Node('lockstep_coordinator', namespace=self.monitor.get_namespace())
        prefix = self.monitor.get_namespace().rstrip('/')
        expected = [f'{prefix}/{name}' for name in nodes]
        # Time waits for the answers to a participant.
        lockstep = Parameter('lockstep', value=True)
        operator = TimedNode(
            'cell_operator', namespace=self.monitor.get_namespace(), parameter_overrides=[lockstep]
        )
        self._triggers = TriggerClients(operator)
        name = operator.get_fully_qualified_name()
        self._coordinator = Coordinator(
            node,
            [*expected, name],
            on_error=self._fail,
            on_held=self._hold,
            held=True,
            recorder=self.recorder,
            callers=(name,),
        )
        self._spinning = SpunNodes((node, operator), 'lock-step')

    def call(self, service: str) -> Future:
        """Call one of `SERVICES` below the namespace; the future holds its response."""
        return (self._triggers or self.monitor.triggers).call(service)

    def release(self) -> None:
        """Let the time of a lock-step run pass."""
        if self._coordinator is not None:
            assert self._spinning is not None
            self._spinning.call(self._coordinator.release)

    def close_recording(self) -> None:
        """Close the bag; that of a lock-step run, which stops here, when it has all that was sent."""
        if self.recorder is None:
            return
        if self._coordinator is not None and self._coordinator.started and not self.problem:
            self._wait_for_recording(self.recorder, self._coordinator)
        self.recorder.close()

    def _wait_for_recording(self, recorder: BagRecorder, coordinator: Coordinator) -> None:
        assert self._spinning is not None
        self.held = False
        self._spinning.call(coordinator.hold)
        deadline = time.monotonic() + PATIENCE
        while not (self.held or self.problem) or recorder.missing(coordinator.sent):
            if self.problem or recorder.problem or time.monotonic() > deadline:
                recorder.problem = recorder.problem or recorder.missing(coordinator.sent)
                return
            time.sleep(POLL)

    def close(self) -> None:
        """End a lock-step run."""
        if self._spinning is not None:
            with bounded_end():
                self._spinning.end()

    def _hold(self) -> None:
        self.held = True

    def _fail(self, error: LockstepError) -> None:
        self.problem = error.message


@contextlib.contextmanager
def listen(namespace: str, bag: Path | None, *, lockstep: bool = False) -> Iterator[CellListener]:
    """Listen to the cell of a namespace, and record it to the folder `bag` where there is one."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    monitor = CellMonitor(namespace=namespace)
    recorder = BagRecorder(bag, namespace=namespace, lockstep=lockstep) if bag is not None else None
    spinning = SpunNodes([node for node in (monitor, recorder) if node is not None], 'cell listener')
    listener = CellListener(monitor, recorder)
    try:
        yield listener
    finally:
        listener.close()
        spinning.stop()
        if recorder is not None:
            recorder.close()
        with bounded_end():  # all nodes of the cell leave at this time
            spinning.end()
        rclpy.shutdown()
