"""Plants in other processes, which are killed, frozen and started again."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from plant_bench import PlantBench
from plant_process import PlantProcess

MODBUS = """
modbus: {{plc: {{host: 127.0.0.1, port: {port}, period: 0.02, response_timeout: 2.0}}}}
inputs: [{{channel: digital_input.1, modbus: {{discrete_input: 0}}, timeout: 1.0, fail_safe: false}}]
outputs: [{{channel: digital_output.1, modbus: {{coil: 0}}}}]
"""
OPCUA = """
opcua: {{plc: {{endpoint: 'opc.tcp://127.0.0.1:{port}', period: 0.02, response_timeout: 2.0}}}}
inputs:
  - channel: digital_input.1
    opcua: {{node: nsu=urn:robots:plc;s=digital_input.1}}
    timeout: 1.0
    fail_safe: false
outputs: [{{channel: digital_output.1, opcua: {{node: nsu=urn:robots:plc;s=digital_output.1}}}}]
"""
MQTT = """
mqtt: {{plc: {{host: 127.0.0.1, port: {port}, response_timeout: 2.0}}}}
inputs: [{{channel: digital_input.1, mqtt: {{topic: plc/digital_input.1}}, timeout: 1.0, fail_safe: false}}]
outputs: [{{channel: digital_output.1, mqtt: {{topic: plc/digital_output.1, retain: true}}}}]
"""
MAPS = {'modbus': MODBUS, 'opcua': OPCUA, 'mqtt': MQTT}


@pytest.fixture(params=MAPS)
def plant(request: pytest.FixtureRequest) -> Iterator[PlantProcess]:
    made = PlantProcess(request.param)
    made.start()
    yield made
    made.kill()


def test_a_plant_that_is_killed_or_frozen_gets_the_newest_output_when_it_is_back(plant: PlantProcess):
    bench = PlantBench(MAPS[plant.protocol].format(port=plant.port))

    def until_it_works(output: float) -> None:
        bench.until(lambda: plant.heard[-1:] == [str(output)], 'the output')
        bench.until(lambda: bench.inputs.get('digital_input.1') == 1.0, 'the input')
        bench.until(lambda: not str(bench.bridge.problems), 'no problem')

    def until_it_is_gone() -> None:
        bench.until(lambda: 'connecting again and again' in str(bench.bridge.problems), 'the loss')
        bench.now += 2.0
        bench.step()
        assert bench.inputs['digital_input.1'] == 0.0

    bench.switch(d1=1.0)
    until_it_works(1.0)
    plant.kill()
    until_it_is_gone()
    bench.switch(d1=0.0)
    plant.start()
    until_it_works(0.0)
    plant.freeze(frozen=True)
    bench.switch(d1=1.0)
    until_it_is_gone()
    plant.freeze(frozen=False)
    until_it_works(1.0)
    bench.close()
