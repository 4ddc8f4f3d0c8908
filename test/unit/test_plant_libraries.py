"""What an I/O map needs of the plant's libraries: those of its own servers."""

from __future__ import annotations

import sys

import pytest

from plant_bench import PlantBench
from robots_core.errors import InvalidInputError

SERVERS = {
    'modbus': ('{host: 127.0.0.1}', '{coil: 0}'),
    'mqtt': ('{host: 127.0.0.1}', '{topic: a}'),
    'opcua': ('{endpoint: "opc.tcp://127.0.0.1:4840"}', '{node: i=1}'),
}
LIBRARIES = {
    'modbus': ('pymodbus.client', 'pymodbus'),
    'mqtt': ('paho.mqtt.client', 'paho-mqtt'),
    'opcua': ('asyncua', 'asyncua'),
}


@pytest.mark.parametrize('protocol', SERVERS)
def test_a_library_that_is_not_installed_is_named_with_the_first_row_that_needs_it(
    protocol: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (server, place), (module, package) = SERVERS[protocol], LIBRARIES[protocol]
    monkeypatch.setitem(sys.modules, module, None)
    text = f'{protocol}: {{plc: {server}}}\ninputs:\n  - {{channel: digital_input.1, {protocol}: {place}}}\n'
    with pytest.raises(InvalidInputError) as info:
        PlantBench(text)
    assert f'io_map.yaml:3: {protocol} needs the package {package}, which cannot be' in str(info.value)
    assert 'make plant-requirements' in str(info.value)
