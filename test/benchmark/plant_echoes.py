"""Bare clients that answer a plant, the peers of benchmark_plant."""

from __future__ import annotations

import asyncio
import socket
import sys
import time
from collections.abc import Callable
from typing import Any

PERIOD = 0.01  # s, of what is polled and of OPC UA subscriptions


def topic(_port: int) -> None:
    """A node that publishes what it receives."""
    import rclpy  # noqa: PLC0415
    from rclpy.node import Node  # noqa: PLC0415
    from std_msgs.msg import UInt8  # noqa: PLC0415

    rclpy.init()
    node = Node('echo')
    answers = node.create_publisher(UInt8, '/plc/bare_answer', 1)
    node.create_subscription(UInt8, '/plc/bare', answers.publish, 1)
    rclpy.spin(node)


def modbus(port: int) -> None:
    """A client that reads a coil again and again and writes another one when it changes."""
    from pymodbus.client import ModbusTcpClient  # noqa: PLC0415

    client = ModbusTcpClient('127.0.0.1', port=port)
    client.connect()
    last = None
    while True:
        value = client.read_coils(1, count=1).bits[0]
        if value != last:
            last = value
            client.write_coil(3, value)
        time.sleep(PERIOD)


def mqtt(port: int) -> None:
    """A client that publishes what it receives."""
    import paho.mqtt.client as paho  # noqa: PLC0415

    client = paho.Client(paho.CallbackAPIVersion.VERSION2)
    client.on_connect = lambda *_: client.subscribe('plant/bare', 1)
    client.on_message = lambda _client, _data, message: client.publish('robot/bare', message.payload, 1)
    client.connect('127.0.0.1', port)
    client.socket().setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    client.loop_forever()


def opcua(port: int) -> None:
    """A client that writes a variable when another one has changed."""
    asyncio.run(_opcua(port))


async def _opcua(port: int) -> None:
    from asyncua import Client  # noqa: PLC0415

    tasks = set()
    async with Client(f'opc.tcp://127.0.0.1:{port}') as client:
        answer = client.get_node('ns=2;s=from_bare')

        class Echo:
            def datachange_notification(self, _node: Any, value: Any, _data: Any) -> None:
                task = asyncio.create_task(answer.write_value(value))
                tasks.add(task)
                task.add_done_callback(tasks.discard)

        subscription = await client.create_subscription(1e3 * PERIOD, Echo())
        await subscription.subscribe_data_change(client.get_node('ns=2;s=to_bare'), sampling_interval=0)
        await asyncio.Event().wait()


ECHOES: dict[str, Callable[[int], None]] = {'topic': topic, 'modbus': modbus, 'mqtt': mqtt, 'opcua': opcua}

if __name__ == '__main__':
    ECHOES[sys.argv[1]](int(sys.argv[2]))
