"""CellMonitor: what happens in the cell, as a stream of plain events."""

import contextlib
import heapq
import itertools
import threading
import time
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Float64, Float64MultiArray, UInt8MultiArray
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robots_controller.io.io_image import Kind
from robots_controller.live_cell.cell_events import (
    Event,
    MotionCommanded,
    MotionPlanned,
    MotionProgress,
    NodeHealth,
    OutputsChanged,
    ProgramPrint,
    ProgramStatus,
)
from robots_core.base_frames import AT_BASE
from robots_core.errors import RobotsError
from robots_core.ros.messages import (
    diagnostic_values,
    message_class,
    motion_result_from_message,
    number_in,
    stamp_id,
)
from robots_core.ros.peers.heartbeat import HEARTBEAT
from robots_core.ros.qos import every_message
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_planning.motion_kinds import MOTION_KINDS, MotionKind
from robots_planning.nodes.motion_messages import target_of

# Topics arrive in any order; after this long everything that was sent before has arrived.
ORDERING_TIME = 0.06  # s
SERVICE_WAIT = 5.0  # s
SERVICES = ('lua_program_node/open', 'lua_program_node/run', 'controller_node/cancel')


class TriggerClients:
    """Calls `SERVICES` of a cell.

    Args:
        node: In the cell's namespace. Its clients are made at once: the answer to one that has only just come
            may not find it.
    """

    def __init__(self, node: Node) -> None:
        self._clients = {name: node.create_client(Trigger, name) for name in SERVICES}

    def call(self, service: str) -> Future:
        """Call one of `SERVICES` below the namespace; the future holds its response."""
        client = self._clients[service]
        client.wait_for_service(timeout_sec=SERVICE_WAIT)
        future: Future = client.call_async(Trigger.Request())
        return future


class CellMonitor(Node):
    """Listens to the cell of a namespace and calls its program services."""

    def __init__(self, *, namespace: str, **options: Any) -> None:
        super().__init__('cell_monitor', namespace=namespace, **options)
        self._outputs: dict[Kind, UInt8MultiArray | Float64MultiArray] = {}
        self.triggers: Final = TriggerClients(self)
        self._lock = threading.Lock()
        self._events: list[tuple[float, int, Event]] = []
        self._count = itertools.count()

        self._listen(DiagnosticArray, '/diagnostics', self._health)
        self._listen(Log, '/rosout', _prints)
        self._listen(DiagnosticStatus, 'program_status', _program_status)
        for kind in MOTION_KINDS:
            listen = partial(_command, kind)
            self._listen(message_class(kind.message_type), kind.topic, listen)
        self._listen(JointTrajectory, 'joint_trajectory', _planned)
        self._listen(DiagnosticStatus, 'motion_result', lambda m: (motion_result_from_message(m),))
        # In every period of a lock-step run; the view shows the newest.
        self._progress = PolledSubscription(self, Float64, 'motion_progress')
        self._listen(UInt8MultiArray, 'digital_outputs', partial(self._changes, 'digital'))
        self._listen(Float64MultiArray, 'analog_outputs', partial(self._changes, 'analog'))

    @property
    def outputs(self) -> dict[Kind, UInt8MultiArray | Float64MultiArray]:
        """The newest images of the outputs."""
        with self._lock:
            return dict(self._outputs)

    def present(self, nodes: Iterable[str]) -> list[str]:
        """Which of these nodes were found so far to give signs of life."""
        return [name for name in nodes if self.count_publishers(f'{name}/{HEARTBEAT}')]

    def take(self) -> list[Event]:
        """Events that are old enough to be in order, oldest first."""
        ready = time.time() - ORDERING_TIME
        taken = []
        with self._lock:
            for message, info in self._progress.take_all():
                self._push(info, MotionProgress(float(message.data)))
            while self._events and self._events[0][0] <= ready:
                taken.append(heapq.heappop(self._events)[2])
        return taken

    def _listen(self, message_type: Any, topic: str, events: Callable[[Any], Iterable[Event]]) -> None:
        def on_message(message: Any, info: dict[str, int]) -> None:
            # What is not valid is refused and reported by the nodes that it is meant for.
            with self._lock, contextlib.suppress(RobotsError):
                for event in events(message):
                    self._push(info, event)

        # rclpy hands the message's info to a callback that takes it; its annotation does not say so.
        self.create_subscription(message_type, topic, on_message, every_message(topic))  # type: ignore[arg-type]

    def _push(self, info: dict[str, int], event: Event) -> None:
        heapq.heappush(self._events, (1e-9 * info['source_timestamp'], next(self._count), event))

    def _health(self, message: DiagnosticArray) -> Iterable[Event]:
        prefix = self.get_namespace().rstrip('/') + '/'
        for status in message.status:
            name = status.name.removeprefix(prefix)
            if status.name.startswith(prefix) and '/' not in name:
                values = diagnostic_values(status)
                yield NodeHealth(
                    pid=int(number_in(values, 'pid', 0.0)),
                    node=name,
                    ok=status.level == DiagnosticStatus.OK,
                    message=status.message,
                    url=values.get('url', ''),
                    works=values.get('was_ready') == 'True',
                )

    def _changes(self, kind: Kind, message: UInt8MultiArray | Float64MultiArray) -> Iterable[Event]:
        values = [float(value) for value in message.data]
        last = self._outputs.get(kind)
        before = [0.0] * len(values) if last is None else [float(value) for value in last.data]
        self._outputs[kind] = message
        changes = tuple(
            (index, new)
            for index, (old, new) in enumerate(zip(before, values, strict=False), 1)
            if old != new
        )
        if changes:
            yield OutputsChanged(kind, changes)


def _prints(message: Log) -> Iterable[Event]:
    if message.name.endswith('lua_program_node.print'):
        yield ProgramPrint(message.msg)


def _program_status(message: DiagnosticStatus) -> Iterable[Event]:
    values = diagnostic_values(message)
    yield ProgramStatus(
        state=values.get('state', ''),
        file=values.get('file', ''),
        line=int(number_in(values, 'line', 0.0)),
        source=values.get('source', ''),
        error=values.get('error', ''),
    )


def _command(kind: MotionKind, message: Any) -> Iterable[Event]:
    target = target_of(kind, message, getattr(message, 'name', ()), AT_BASE)
    if isinstance(target, tuple):
        if not target:  # planning_node refuses it and says why
            return
        target = target[-1]
    yield MotionCommanded(stamp_id(message.header.stamp), kind.title, target)


def _planned(message: JointTrajectory) -> Iterable[Event]:
    if message.points:
        end = message.points[-1].time_from_start
        streamed = len(message.points) == 1
        yield MotionPlanned(stamp_id(message.header.stamp), end.sec + 1e-9 * end.nanosec, streamed)
