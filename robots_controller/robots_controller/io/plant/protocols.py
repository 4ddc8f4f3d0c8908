"""The protocols of an I/O map: their servers and places in its file."""

from collections.abc import Mapping
from typing import Final, TypeAlias

from robots_controller.io.bridge.io_port import Place
from robots_controller.io.io_image import Channel
from robots_controller.io.plant.modbus import ModbusServer
from robots_controller.io.plant.mqtt import MqttServer
from robots_controller.io.plant.opcua import OpcuaServer
from robots_core.files.yaml_section import YamlSection

PlantServer: TypeAlias = ModbusServer | MqttServer | OpcuaServer
"""A server that a map declares: its `port`, as of its places, and the `period` of inputs whose row has none,
s; None where the server speaks by itself.

`read` and `read_place` raise an InvalidInputError with file and line where a key is missing or not valid.
"""

PROTOCOLS: Final[Mapping[str, type[PlantServer]]] = {
    'modbus': ModbusServer,
    'mqtt': MqttServer,
    'opcua': OpcuaServer,
}
"""By the names that maps have for them."""


def read_servers(section: YamlSection) -> dict[str, PlantServer]:
    """The servers of a map, by protocol and name with a space between.

    Raises:
        InvalidInputError: what is wrong, with its line.
    """
    servers: dict[str, PlantServer] = {}
    for name, protocol in PROTOCOLS.items():
        for below, server in section.entries(name):
            if (entry := below.section(server)) is None or not server:
                raise below.error(f'{name} needs a name and settings for each server', server)
            port = f'{name} {server}'
            servers[port] = protocol.read(entry, port)
    return servers


def read_plant_place(
    item: YamlSection, channel: Channel, servers: Mapping[str, PlantServer]
) -> tuple[Place, PlantServer] | None:
    """The place of a row at a server, which it names where there are several; None for a row of a topic.

    Raises:
        InvalidInputError: what is wrong, with its line.
    """
    named = [name for name in (*PROTOCOLS, 'topic') if name in item]
    if len(named) > 1:
        raise item.error(f'{" and ".join(named)} exclude each other; a row has one place', named[1])
    if not named or named[0] == 'topic':
        return None
    (name,) = named
    below = item.needed_section(name)
    own = [port.removeprefix(f'{name} ') for port in servers if port.startswith(f'{name} ')]
    if not own:
        raise item.error(f'there is no server below {name} at the top of the file', name)
    server = servers[f'{name} {below.text("server", own[0] if len(own) == 1 else None, among=own)}']
    return server.read_place(below, channel), server
