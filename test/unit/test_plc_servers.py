"""A scripted PLC as a server of a plant's protocols and at a broker, connected with a robot by an I/O map."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from typing import Any

import pytest

from plant_bench import PlantBench
from plant_partners import MqttPartner, free_port
from robots_controller.io.io_image import Channel
from robots_controller.io.plant.modbus_plc import ModbusPlc
from robots_controller.io.plant.mqtt_plc import MqttPlc
from robots_controller.io.plant.opcua_plc import OpcuaPlc
from robots_core.errors import InvalidInputError

MODBUS = """
modbus: {{plc: {{host: 127.0.0.1, port: {port}, period: 0.02, response_timeout: 60.0}}}}
inputs:
  - {{channel: digital_input.2, modbus: {{discrete_input: 1}}}}
  - {{channel: analog_input.3, modbus: {{input_register: 4, type: float32}}}}
outputs:
  - {{channel: digital_output.1, modbus: {{coil: 0}}}}
  - {{channel: analog_output.2, modbus: {{holding_register: 2, type: float32}}}}
"""
OPCUA = """
opcua: {{plc: {{endpoint: 'opc.tcp://127.0.0.1:{port}', period: 0.02, response_timeout: 60.0}}}}
inputs:
  - {{channel: digital_input.2, opcua: {{node: nsu=urn:robots:plc;s=digital_input.2}}}}
  - {{channel: analog_input.3, opcua: {{node: nsu=urn:robots:plc;s=analog_input.3}}}}
outputs:
  - {{channel: digital_output.1, opcua: {{node: nsu=urn:robots:plc;s=digital_output.1}}}}
  - {{channel: analog_output.2, opcua: {{node: nsu=urn:robots:plc;s=analog_output.2}}}}
"""
MQTT = """
mqtt: {{plc: {{host: 127.0.0.1, port: {port}, response_timeout: 60.0}}}}
inputs:
  - {{channel: digital_input.2, mqtt: {{topic: plc/digital_input.2}}}}
  - {{channel: analog_input.3, mqtt: {{topic: plc/analog_input.3}}}}
outputs:
  - {{channel: digital_output.1, mqtt: {{topic: plc/digital_output.1, retain: true}}}}
  - {{channel: analog_output.2, mqtt: {{topic: plc/analog_output.2, retain: true}}}}
"""
MAPS: dict[Any, str] = {ModbusPlc: MODBUS, OpcuaPlc: OPCUA, MqttPlc: MQTT}
CHANNELS = [
    Channel(kind, direction, index)
    for kind, direction, index in (
        ('digital', 'input', 2),
        ('analog', 'input', 3),
        ('digital', 'output', 1),
        ('analog', 'output', 2),
    )
]
READY, FORCE = CHANNELS[:2]


class Plant:
    """A PLC, and the robot's I/O bridge as its client."""

    def __init__(self, kind: Any) -> None:
        self.broker = MqttPartner() if kind is MqttPlc else None
        self.port = self.broker.port if self.broker else free_port()
        if self.broker:
            self.broker.start()
        self.heard: dict[str, float] = {}
        self.plc = kind(CHANNELS, self.port, self.heard.__setitem__)
        self.bench = PlantBench(MAPS[kind].format(port=self.port))

    def close(self) -> None:
        self.bench.close()
        self.plc.close()
        if self.broker:
            self.broker.end()


@pytest.fixture(scope='module', params=MAPS, ids=lambda kind: kind.__name__)
def plant(request: pytest.FixtureRequest) -> Iterator[Plant]:
    made = Plant(request.param)
    yield made
    made.close()


def test_inputs_of_the_robot_are_read_from_the_plc(plant: Plant) -> None:
    plant.plc.set({READY: 1.0, FORCE: 2.5})
    plant.bench.until(
        lambda: (plant.bench.inputs.get(READY.name), plant.bench.inputs.get(FORCE.name)) == (1.0, 2.5),
        'the inputs',
    )


def test_outputs_of_the_robot_reach_the_plc(plant: Plant) -> None:
    plant.bench.switch(d1=1.0, a2=-7.25)
    plant.bench.until(
        lambda: (plant.heard.get('digital_output.1'), plant.heard.get('analog_output.2')) == (1.0, -7.25),
        'the outputs',
    )


@pytest.mark.parametrize('kind', [ModbusPlc, OpcuaPlc])
def test_a_port_that_is_taken_is_named(kind: Any) -> None:
    with socket.create_server(('127.0.0.1', 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(InvalidInputError, match=f'port {port} is taken'):
            kind(CHANNELS, port, lambda *_: None)


def test_numbers_that_are_not_finite_are_refused(plant: Plant) -> None:
    plant.bench.switch(a2=3.0)
    plant.bench.until(lambda: plant.heard.get('analog_output.2') == 3.0, 'the output')
    plant.bench.switch(a2=float('nan'))
    plant.bench.switch(d1=0.0)
    plant.bench.until(lambda: plant.heard.get('digital_output.1') == 0.0, 'the next output')
    assert plant.heard['analog_output.2'] == 3.0


def test_a_broker_that_comes_late_and_goes_has_the_newest_inputs() -> None:
    broker = MqttPartner()
    heard: list[tuple[str, float]] = []
    plc = MqttPlc(CHANNELS, broker.port, lambda *values: heard.append(values))
    plc.set({READY: 1.0, FORCE: 1.5})
    bench = PlantBench(MQTT.format(port=broker.port))
    for force in (2.5, 3.5):
        plc.set({FORCE: force})
        broker.start()
        wanted = (1.0, force)
        bench.until(
            lambda wanted=wanted: (bench.inputs.get(READY.name), bench.inputs.get(FORCE.name)) == wanted,  # type: ignore[misc]
            'the inputs',
        )
        bench.switch(a2=force)
        bench.until(lambda force=force: ('analog_output.2', force) in heard, 'the output')  # type: ignore[misc]
        broker.stop()
    bench.close()
    plc.close()
    broker.end()


def test_messages_that_are_no_numbers_are_left_out() -> None:
    broker = MqttPartner()
    broker.start()
    heard: list[float] = []
    plc = MqttPlc(CHANNELS, broker.port, lambda _, value: heard.append(value))
    bench = PlantBench(MQTT.format(port=broker.port))
    bench.switch(a2=1.0)
    bench.until(lambda: heard == [1.0], 'the first')
    texts = [
        'on',
        '"on"',
        '[1]',
        '{}',
        'null',
        'NaN',
        '1e999',
        '1' + 400 * '0',
        100_000 * '[',
        json.dumps(2.0),
    ]
    broker.publish('plc/analog_output.2', *texts)
    bench.until(lambda: heard[1:] == [2.0], 'the last')
    bench.close()
    plc.close()
    broker.end()
