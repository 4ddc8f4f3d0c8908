"""The connections of an I/O map's servers."""

from collections.abc import Callable, Iterable

from robots_controller.io.bridge.place import Place
from robots_controller.io.io_map import IoRow
from robots_controller.io.plant.modbus.modbus_link import ModbusLink
from robots_controller.io.plant.modbus.modbus_map import ModbusServer
from robots_controller.io.plant.mqtt.mqtt_link import MqttLink
from robots_controller.io.plant.mqtt.mqtt_map import MqttServer
from robots_controller.io.plant.opcua.opcua_link import OpcuaLink
from robots_controller.io.plant.opcua.opcua_map import OpcuaServer
from robots_controller.io.plant.plant_connection import PlantConnection
from robots_controller.io.plant.plant_link import PlantLink
from robots_controller.io.plant.protocols import PlantServer
from robots_core.errors import InvalidInputError


def connect(
    server: PlantServer, rows: Iterable[IoRow], wake: Callable[[], None], **options: float
) -> PlantConnection:
    """The connection of a server; it connects by itself.

    Args:
        server: The server.
        rows: Those with places there.
        wake: Called in another thread when values have arrived or the state has changed.
        options: Of `PlantConnection`.

    Raises:
        InvalidInputError: the protocol's library is not installed.
    """
    inputs: dict[Place, float] = {}
    outputs: dict[Place, None] = {}
    first: IoRow | None = None
    for row in rows:
        first = first or row
        if row.channel.direction == 'output':
            outputs[row.place] = None
        else:
            inputs[row.place] = min(row.period, inputs.get(row.place, row.period))
    link: PlantLink
    try:
        match server:
            case ModbusServer():
                link = ModbusLink(server, inputs)
            case MqttServer():
                link = MqttLink(server, inputs, outputs)
            case OpcuaServer():
                link = OpcuaLink(server, inputs, outputs)
    except InvalidInputError as error:
        raise (first.error(error.message) if first else error) from None
    return PlantConnection(server.port, link, wake, **options)
