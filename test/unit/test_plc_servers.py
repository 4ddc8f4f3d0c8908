"""A scripted PLC as a server of a plant's protocols, connected with a robot by an I/O map."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from plant_bench import PlantBench
from plant_partners import free_port
from robots_controller.io.io_image import Channel
from robots_controller.io.plant.modbus.modbus_plc import ModbusPlc
from robots_controller.io.plant.opcua.opcua_plc import OpcuaPlc
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
MAPS: dict[Any, str] = {ModbusPlc: MODBUS, OpcuaPlc: OPCUA}
CHANNELS = [Channel('digital', 'input', 2), Channel('analog', 'input', 3), Channel('digital', 'output', 1)]
READY, FORCE = CHANNELS[:2]


class Plant:
    """A PLC, and the robot's I/O bridge as its client."""

    def __init__(self, kind: Any) -> None:
        self.port = free_port()
        self.heard: dict[str, float] = {}
        self.plc = kind(CHANNELS, self.port, self.heard.__setitem__)
        self.bench = PlantBench(MAPS[kind].format(port=self.port))

    def close(self) -> None:
        self.bench.close()
        self.plc.close()


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


def test_a_port_that_is_taken_is_named(plant: Plant) -> None:
    with pytest.raises(InvalidInputError, match=f'port {plant.port} is taken'):
        type(plant.plc)(CHANNELS, plant.port, lambda *_: None)


def test_numbers_that_are_not_finite_are_refused(plant: Plant) -> None:
    plant.bench.switch(a2=3.0)
    plant.bench.until(lambda: plant.heard.get('analog_output.2') == 3.0, 'the output')
    plant.bench.switch(a2=float('nan'))
    plant.bench.switch(d1=0.0)
    plant.bench.until(lambda: plant.heard.get('digital_output.1') == 0.0, 'the next output')
    assert plant.heard['analog_output.2'] == 3.0
