"""Servers of a plant's protocols for tests, each as its library makes it, in a thread of this process."""

from __future__ import annotations

import asyncio
import json
import socket
import threading
from collections.abc import Coroutine
from contextlib import suppress
from typing import Any, TypeVar

import paho.mqtt.client as mqtt
from amqtt.broker import Broker
from pymodbus.constants import ExcCodes
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

Result = TypeVar('Result')

DEADLINE = 120.0  # s
TABLES = ('coil', 'discrete_input', 'holding_register', 'input_register')
READ_CODES = {'coil': 1, 'discrete_input': 2, 'holding_register': 3, 'input_register': 4}
WRITE_CODES = {5: 'coil', 15: 'coil', 6: 'holding_register', 16: 'holding_register'}


def free_port() -> int:
    """A TCP port of this machine that nothing listens to now."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return int(probe.getsockname()[1])


class Partner:
    """An asyncio server in a thread; it can stop and start again, as a PLC that is switched off and on."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()

    def call(self, work: Coroutine[Any, Any, Result]) -> Result:
        """Do something in the server's thread."""
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(DEADLINE)

    def start(self) -> None:
        """Listen."""
        self.call(self._start())

    def stop(self) -> None:
        """Close all connections, and listen no more."""
        self.call(self._stop())

    def end(self) -> None:
        """End the thread too."""
        self.stop()
        self.call(self._cancel_others())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(DEADLINE)
        self._loop.close()

    async def _start(self) -> None:
        raise NotImplementedError

    async def _stop(self) -> None:
        raise NotImplementedError

    @staticmethod
    async def _cancel_others() -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)


class Listening(Partner):
    """A server of bare bytes, at a free port."""

    def __init__(self) -> None:
        super().__init__()
        self.port = free_port()
        self._server: asyncio.Server | None = None

    async def _start(self) -> None:
        self._server = await asyncio.start_server(self._connect, '127.0.0.1', self.port)

    async def _stop(self) -> None:
        if self._server is not None:
            self._server.close()
            self._server = None

    async def _connect(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        raise NotImplementedError


class Line(Listening):
    """The line to a server: what the server sends arrives late, or not before it is let through.

    Args:
        port: Of the server.
        delay: Of each answer, s.
    """

    def __init__(self, port: int, delay: float = 0.0) -> None:
        super().__init__()
        self.delay = delay
        self._to = port
        self._through = asyncio.Event()
        self._through.set()
        self._clients: list[asyncio.StreamWriter] = []

    async def _stop(self) -> None:
        await super()._stop()
        for client in self._clients:
            client.close()

    def hold(self, *, held: bool) -> None:
        """Let nothing of the server through, or all."""
        self._loop.call_soon_threadsafe(self._through.clear if held else self._through.set)

    def shout(self, noise: bytes) -> None:
        """Send something to all clients."""
        for client in self._clients:
            self._loop.call_soon_threadsafe(client.write, noise)

    async def _connect(self, reader: asyncio.StreamReader, client: asyncio.StreamWriter) -> None:
        answers, server = await asyncio.open_connection('127.0.0.1', self._to)
        self._clients.append(client)
        await asyncio.gather(self._forward(reader, server), self._forward(answers, client, late=True))

    async def _forward(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, late: bool = False
    ) -> None:
        with suppress(ConnectionError):
            while data := await reader.read(65536):
                if late:
                    await asyncio.sleep(self.delay)
                    await self._through.wait()
                writer.write(data)
        writer.close()


class Babbler(Listening):
    """A server that answers whatever it is sent with the same bytes.

    Args:
        answer: The bytes.
        end: What it does then: 'close', 'wait' or 'repeat' them without end.
    """

    def __init__(self, answer: bytes, end: str) -> None:
        super().__init__()
        self.clients = 0
        self._answer, self._end = answer, end

    async def _connect(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.clients += 1
        with suppress(ConnectionError):
            await reader.read(65536)
            writer.write(self._answer)
            await writer.drain()
            while self._end == 'repeat':
                writer.write(self._answer)
                await writer.drain()
            if self._end == 'wait':
                await reader.read()
        writer.close()


class ModbusPartner(Partner):
    """A Modbus TCP server.

    Args:
        size: Coils and discrete inputs, and registers of each table.
    """

    def __init__(self, size: int = 32) -> None:
        super().__init__()
        self.port = free_port()
        self._size = size
        self.written: list[tuple[str, int, list[int]]] = []
        """What clients have written: table, address, values."""
        self.requests: list[int] = []
        """Function codes."""
        self.refuse: set[int] = set()
        """Addresses that are refused as busy."""
        self.answers = asyncio.Event()
        """Not set: requests are not answered."""
        self.answers.set()
        self.delay = 0.0
        """Of each answer, s."""
        self._server: Any = None
        self._own = False

    async def _start(self) -> None:
        bits = [SimData(0, count=self._size, values=False, datatype=DataType.BITS)]
        words = [SimData(0, count=self._size, values=0, datatype=DataType.REGISTERS)]
        device = SimDevice(0, simdata=(bits, bits, words, words), action=self._on_request)
        self._server = ModbusTcpServer(device, address=('127.0.0.1', self.port))
        await self._server.serve_forever(background=True)

    async def _stop(self) -> None:
        if self._server is not None:
            await self._server.shutdown()
            self._server = None

    async def answer(self) -> None:
        """Answer requests again."""
        self.answers.set()

    def set(self, table: str, address: int, values: list[Any]) -> None:
        """Set what the server has."""
        self.call(self._set(table, address, values))

    def get(self, table: str, address: int, count: int = 1) -> list[Any]:
        """What the server has."""
        return self.call(self._get(table, address, count))

    async def _set(self, table: str, address: int, values: list[Any]) -> None:
        self._own = True
        await self._server.async_setValues(0, READ_CODES[table], address, values)
        self._own = False

    async def _get(self, table: str, address: int, count: int) -> list[Any]:
        self._own = True
        values: list[Any] = await self._server.async_getValues(0, READ_CODES[table], address, count)
        self._own = False
        return values[:count]

    async def _on_request(
        self, code: int, _start: int, address: int, count: int, _now: list[int], values: list[Any] | None
    ) -> ExcCodes | None:
        if self._own:
            return None
        self.requests.append(code)
        await asyncio.sleep(self.delay)
        await self.answers.wait()
        if self.refuse & set(range(address, address + max(count, len(values or ())))):
            return ExcCodes.DEVICE_BUSY
        if code in WRITE_CODES and values:
            self.written.append((WRITE_CODES[code], address, [int(value) for value in values]))
        return None


class MqttPartner(Partner):
    """An MQTT broker of amqtt, and a device at it that publishes and listens.

    Args:
        users: It knows whoever gives a name; nobody else is let in. By default everybody is.
        certificate: PEM files of its certificate and key, with which it encrypts.
    """

    def __init__(self, *, users: bool = False, certificate: tuple[str, str] | None = None) -> None:
        super().__init__()
        self.port = free_port()
        self.heard: list[tuple[str, Any]] = []
        """Messages of all topics of the robot: topic and document."""
        self._users, self._certificate = users, certificate
        self._broker: Any = None
        self._device: Any = None

    async def _start(self) -> None:
        listener: dict[str, Any] = {'type': 'tcp', 'bind': f'127.0.0.1:{self.port}'}
        if self._certificate:
            listener |= {'ssl': True, 'certfile': self._certificate[0], 'keyfile': self._certificate[1]}
        config = {
            'listeners': {'default': listener},
            'plugins': {
                'amqtt.plugins.authentication.AnonymousAuthPlugin': {'allow_anonymous': not self._users}
            },
        }
        self._broker = Broker(config)
        await self._broker.start()

    async def _stop(self) -> None:
        if self._broker is not None:
            await self._broker.shutdown()
            self._broker = None

    def start(self) -> None:
        """Listen, and let the device connect."""
        super().start()
        self._device = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
        self._device.username_pw_set('device')
        if self._certificate:
            self._device.tls_set(self._certificate[0])
            self._device.tls_insecure_set(True)  # the certificate is of another name of this machine
        self._device.on_message = lambda _client, _data, message: self.heard.append(
            (message.topic, json.loads(message.payload))
        )
        subscribed = threading.Event()
        self._device.on_connect = lambda client, *_: client.subscribe('robot/#', 1)
        self._device.on_subscribe = lambda *_: subscribed.set()
        self._device.connect('127.0.0.1', self.port)
        self._device.loop_start()
        assert subscribed.wait(DEADLINE)

    def stop(self) -> None:
        """Disconnect the device, and listen no more."""
        if self._device is not None:
            self._device.disconnect()
            self._device.loop_stop()
            self._device = None
        super().stop()

    def publish(self, topic: str, *payloads: str) -> None:
        """Publish as the device."""
        for payload in payloads:
            message = self._device.publish(topic, payload, 1)
        message.wait_for_publish(DEADLINE)

    def publish_each(self, messages: dict[str, str]) -> None:
        """Publish to many topics as the device."""
        for message in [self._device.publish(topic, payload, 1) for topic, payload in messages.items()]:
            message.wait_for_publish(DEADLINE)
