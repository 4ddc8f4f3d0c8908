"""io_bridge_node: connects inputs and outputs with a PLC by topics or protocols, as mapped in a YAML file."""

import math
import time
from collections.abc import Iterable
from datetime import UTC, datetime
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import DescribeParameters

from robots_controller.io.bridge.io_bridge import WRITER, IoBridge
from robots_controller.io.bridge.io_port import IoPort
from robots_controller.io.bridge.topic_field import TopicField
from robots_controller.io.fail_safe import parse_fail_safe
from robots_controller.io.io_map import IoMap, IoRow, read_io_map
from robots_controller.io.plant.plant_connection import connect
from robots_controller.nodes.ports.io_images import InputImages, OutputImages
from robots_controller.nodes.ports.topic_ports import InputTopic, OutputTopic
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.peers.heartbeat import HeartbeatWatch, watchdog_parameter
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run

# A small part of the shortest timeout.
WATCH_PERIOD: Final = 0.02  # s
FINISH_TIMEOUT: Final = 0.5  # s, for the last values to arrive


class IoBridgeNode(RobotNode):
    """Inputs from topics and protocols, outputs to them."""

    diagnostics_group = 'plant'
    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('io_bridge_node', **options)
        path = self.parameter('io_map', '', 'YAML file that maps channels to topics and protocols')
        self._map = read_io_map(path) if path else IoMap()
        if self.participant is not None:
            self._map.check_simulated_time()
        declared = self.parameter(
            'fail_safe',
            [''],
            "fail-safe values of outputs that the map does not declare, as 'digital_output.3=hold'",
            read=parse_fail_safe,
        )
        self._images = InputImages(self, [row.channel for row in self._map.inputs])
        # Before the ports, whose arrivals it wakes for.
        self._arrived = self.create_guard_condition(self._update_inputs)
        self._timer = self.create_timer(WATCH_PERIOD, self._update_inputs, autostart=False)
        self._ports = self._open_ports()
        self.bridge = IoBridge(
            self._map,
            self._ports,
            {**declared, **self._map.fail_safe},
            self.journal.warning,
            self.now(),
        )
        self._outputs = OutputImages(self, [row.channel for row in self._map.outputs], self._on_outputs)
        for period, repeat in self.bridge.repetitions():
            self.create_timer(period, repeat)
        self.create_service(DescribeParameters, '~/describe_io', self._describe)
        self.ready()  # also without a PLC
        self._update_inputs()
        # The program's node may die after its outputs have arrived and before its first heartbeat.
        self._watch = HeartbeatWatch(
            self, [WRITER], watchdog_parameter(self), lambda *_: self._on_outputs(), by_discovery=True
        )
        if self._map.outputs:
            self.create_timer(WATCH_PERIOD, self._on_outputs)
        self._report()

    def _open_ports(self) -> dict[str, IoPort]:
        ports: dict[str, IoPort] = {}
        for name, rows in _by_port((*self._map.inputs, *self._map.outputs)).items():
            fields = [(row, row.place) for row in rows if isinstance(row.place, TopicField)]
            if not fields:
                ports[name] = connect(self._map.servers[name], rows, self._arrived.trigger)
            elif rows[0].channel.direction == 'input':
                ports[name] = InputTopic(self, fields, self._update_inputs)
            else:
                ports[name] = OutputTopic(self, fields)
        return ports

    def _describe(self, request: DescribeParameters.Request, response: DescribeParameters.Response) -> Any:
        """Place and source time of channels, by their names or labels."""
        texts: dict[str, list[str]] = {}
        for channel, place, stamp in self.bridge.places():
            text = place.text if place.text == place.source else f'{place.text} of {place.source}'
            if math.isfinite(stamp):
                text += f', measured {datetime.fromtimestamp(stamp, UTC).isoformat()}'
            for name in filter(None, (channel.name, channel.label)):
                texts.setdefault(name, []).append(text)
        response.descriptors = [
            ParameterDescriptor(name=name, description='; '.join(texts.get(name, ['is not in the I/O map'])))
            for name in request.names
        ]
        return response

    def _report(self) -> None:
        problems = str(self.bridge.problems)
        if problems:
            self.report_health(DiagnosticStatus.WARN, problems, values_lost=self.bridge.problems.count)
        elif not self._ports:
            self.ready('ready; parameter io_map is empty, nothing is connected')
        else:
            self.ready(inputs=len(self._map.inputs), outputs=len(self._map.outputs))

    def _update_inputs(self) -> None:
        now = self.now()
        for channel, value in self.bridge.take_inputs(now):
            self._images.set(channel, value)
        self._images.publish(self.bridge.unknown)
        for port in self._ports.values():
            for text in port.news():
                self.journal.info(text)
        self._report()
        due = self.bridge.next_time - now
        if due == float('inf'):
            self._timer.cancel()
        else:
            self._timer.timer_period_ns = max(1_000_000, int(1e9 * due))
            self._timer.reset()

    def _on_outputs(self) -> None:
        self.bridge.send_outputs(self._outputs, self.now(), lost=bool(self._watch.lost))
        self._report()

    def destroy_node(self) -> None:
        """Leave the PLC with fail-safe values."""
        if self.context.ok():
            self.bridge.make_safe(self._outputs, self.now())
            end = time.monotonic() + FINISH_TIMEOUT  # simulated time may stand when a node ends
            for port in self._ports.values():
                port.finish(end)
        for port in self._ports.values():
            port.close()
        super().destroy_node()


def _by_port(rows: Iterable[IoRow]) -> dict[str, list[IoRow]]:
    ports: dict[str, list[IoRow]] = {}
    for row in rows:
        ports.setdefault(row.place.port, []).append(row)
    return ports


main: Final = partial(run, IoBridgeNode)
