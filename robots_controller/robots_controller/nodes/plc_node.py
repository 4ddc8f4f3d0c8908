"""plc_node: a scripted PLC, for tests and demonstrations."""

import math
from collections import deque
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus

from robots_controller.io.io_image import Channel
from robots_controller.io.plant.modbus_plc import ModbusPlc
from robots_controller.io.plant.mqtt_plc import MqttPlc
from robots_controller.io.plant.opcua_plc import OpcuaPlc
from robots_controller.io.plant.plc_server import PlcServer
from robots_controller.io.plc_script import PlcScript, read_plc_script
from robots_controller.io.scripted_plc import ScriptedPlc, pending_as_text
from robots_controller.nodes.ports.io_images import InputImages, OutputImages
from robots_core.errors import InvalidInputError
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import diagnostic_status
from robots_core.ros.qos import make_publisher
from robots_core.ros.robot_node import PORTS, RobotNode
from robots_core.ros.running.run import run

PORT: Final = 'at this port of this machine, with the addresses of its channels; 0: none'
MOST_PENDING: Final = 20  # that are published
IDLE_PERIOD: Final = 3600.0  # s, of a timer that has nothing to do


class PlcNode(RobotNode):
    """Subscribes to the outputs and sets the inputs by the rules of a script.

    With a port for Modbus or OPC UA it is a server instead, and with one for MQTT a client of a broker, as a
    PLC in a plant: an I/O map connects the robot with it.

    On the wall clock it acts at once. In simulated time it acts as a PLC does, at the end of a cycle, on the
    outputs that have come since the last one, in their order.
    """

    diagnostics_group = 'plant'
    phase = Phase.OBSERVE  # after the controller: in the cycle in which outputs are switched on the path

    def __init__(self, **options: Any) -> None:
        super().__init__('plc_node', **options)
        path = self.parameter('script', '', 'YAML file with the rules of the PLC')
        cycle = self.parameter('cycle', 0.004, 'of the PLC in simulated time, s', bounds=(1e-4, 10.0))
        script = read_plc_script(path) if path else PlcScript(())
        servers: dict[type[PlcServer], int] = {
            ModbusPlc: self.parameter('modbus_port', 0, f'as a Modbus TCP server, {PORT}', bounds=PORTS),
            MqttPlc: self.parameter('mqtt_port', 0, f'as a client of an MQTT broker {PORT}', bounds=PORTS),
            OpcuaPlc: self.parameter('opcua_port', 0, f'as an OPC UA server, {PORT}', bounds=PORTS),
        }
        self._plc = ScriptedPlc(script, self.now())
        self._timer = self.create_timer(IDLE_PERIOD, self._step, autostart=False)
        self._written: deque[tuple[str, float]] = deque()
        self._received = self.create_guard_condition(self._on_written)
        self._servers: list[PlcServer] = [
            make(script.channels, port, self._receive) for make, port in servers.items() if port
        ]
        for server in self._servers:
            self.closing.callback(server.close)
        if self._servers and self.simulated_time:
            raise InvalidInputError(
                'a PLC in simulated time is no server and at no broker: clients have another time'
            )
        # Where clients set the robot's inputs, their topic is not the PLC's.
        self._inputs = InputImages(self, () if self._servers else script.inputs)
        self._outputs = OutputImages(self, () if self._servers else self._plc.outputs, self._on_outputs)
        self._set_inputs(self._plc.inputs)
        self._script_name = Path(path).name
        self._status = make_publisher(self, DiagnosticStatus, 'plc_status')
        self._published: object = None
        self.ready('ready' if path else 'ready; parameter script is empty, no input is set')
        if self.simulated_time:
            self.start_loop(lambda _: self._step(), period=cycle, name='PLC', next_time=self._next_time)
        else:
            self._step()

    def _next_time(self) -> float:
        return 0.0 if self._published is None else self._plc.next_time

    def _set_inputs(self, values: Mapping[Channel, float]) -> None:
        for server in self._servers:
            server.set(values)
        if not self._servers:
            for channel, value in values.items():
                self._inputs.set(channel, value)
            self._inputs.publish()

    def _receive(self, name: str, value: float) -> None:
        self._written.append((name, value))
        self._received.trigger()

    def _on_written(self) -> None:
        while self._written:
            self._plc.output(*self._written.popleft())
        self._step()

    def _on_outputs(self) -> None:
        for channel in self._plc.outputs:
            value = self._outputs.value(channel)
            if value is not None:
                self._plc.output(channel.name, value)
        if not self.simulated_time:
            self._step()

    def _step(self) -> None:
        now = self.now()
        try:
            changes = self._plc.step(now)
        except InvalidInputError as error:
            self.journal.error(str(error))
            self.report_health(DiagnosticStatus.ERROR, str(error))
            self._publish_status(str(error))
            self._timer.cancel()
            return
        for change in changes:
            self._set_inputs({change.channel: change.value})
        self._publish_status()
        if not self.simulated_time:
            due = self._plc.next_time - now
            self._timer.timer_period_ns = int(1e9 * (IDLE_PERIOD if due == math.inf else max(1e-4, due)))
            self._timer.reset()

    def _publish_status(self, error: str = '') -> None:
        """Publish what the PLC will do, if that is not what was published before."""
        pending = self._plc.pending[:MOST_PENDING]
        if (error, pending) == self._published:
            return
        self._published = error, pending
        start = 1e-9 * self.get_clock().now().nanoseconds - self.now()
        status = diagnostic_status(
            'plc',
            error or 'ready',
            level=DiagnosticStatus.ERROR if error else DiagnosticStatus.OK,
            hardware_id=self.robot_name,
            script=self._script_name,
            pending=pending_as_text(pending, start),
        )
        self._status.publish(status)


main: Final = partial(run, PlcNode)
