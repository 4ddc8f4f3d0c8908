"""Clients that send our OPC UA servers what is not OPC UA, or messages without end."""

from __future__ import annotations

import asyncio
import socket
import struct
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest

from opcua_bench import Served
from opcua_client import as_client
from plant_partners import DEADLINE, free_port
from robots_controller.io.plant.opcua_plc import OpcuaPlc
from robots_controller.opcua.server_settings import ServerSettings

LONG = 65_000
HELLO = struct.pack('<3scIIIIIIi', b'HEL', b'F', 32, 0, 65535, 65535, 0, 0, -1)


@pytest.fixture(scope='module', params=['plc', 'robot'])
def port(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    if request.param == 'plc':
        number = free_port()
        server: Any = OpcuaPlc([], number, lambda *_: None)
    else:
        served = Served(ServerSettings(), tmp_path_factory.mktemp('programs'))
        number, server = served.port, served.server
    server._server.iserver.max_pending_activation_seconds = (
        0.0  # s; it would close quiet connections by itself
    )
    yield number
    server.close()


def chunks(count: int, size: int) -> bytes:
    """The first chunks of a message that does not end, each as OPC UA has it."""
    body = (size - 24) * b'x'
    return b''.join(struct.pack('<3scIIIII', b'MSG', b'C', size, 0, 0, n, 1) + body for n in range(count))


@pytest.mark.parametrize(
    'sent',
    [
        b'GET / HTTP/1.1\r\n\r\n',
        1000 * b'\xff',
        struct.pack('<3scI', b'HEL', b'F', 0xFFFFFFFF),
        struct.pack('<3scI', b'MSG', b'F', 7),
        HELLO + struct.pack('<3scI', b'OPN', b'F', 1 << 30),
        HELLO + chunks(2049, 24),
        HELLO + chunks(259, LONG),
    ],
    ids=['http', 'noise', 'long_hello', 'short', 'long_open', 'chunks', 'bytes'],
)
def test_the_connection_is_closed(port: int, sent: bytes) -> None:
    with socket.create_connection(('127.0.0.1', port), DEADLINE) as client, suppress(ConnectionError):
        client.sendall(sent)
        while client.recv(65536):
            pass


def test_others_are_served_all_the_same(port: int) -> None:
    async def state(nodes: Any) -> Any:
        return await nodes.client.nodes.server_state.read_value()

    assert asyncio.run(as_client(f'opc.tcp://127.0.0.1:{port}', state)) == 0
