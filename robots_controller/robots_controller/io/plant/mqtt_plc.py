"""MqttPlc: a PLC at an MQTT broker; its topics are named as the robot's channels: plc/digital_input.1."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from threading import Lock
from typing import Any, Final

from robots_controller.io.io_image import Channel
from robots_controller.io.plant.plant_link import library
from robots_controller.io.plant.plc_server import HOST, OnWritten

TOPIC: Final = 'plc'
QOS: Final = 1
RECONNECT: Final = (1, 5)  # s, shortest and longest pause


class MqttPlc:
    """See `PlcServer`; a client of a broker that may come and go, without encryption.

    Inputs of the robot are retained messages, of which the value is all. Other messages than finite numbers
    and booleans are left out.
    """

    def __init__(self, channels: Iterable[Channel], port: int, on_written: OnWritten) -> None:
        self._on_written = on_written
        paho = library('paho.mqtt.client', 'paho-mqtt', 'mqtt')
        self._names = {topic_of(one): one.name for one in channels if one.direction == 'output'}
        self._messages: dict[str, str] = {}
        self._setting = Lock()
        """Of messages and their publication, so that the newest is published last."""
        self._client = paho.Client(paho.CallbackAPIVersion.VERSION2)
        self._client.on_connect, self._client.on_message = self._on_connect, self._on_message
        self._client.reconnect_delay_set(*RECONNECT)
        self._client.connect_async(HOST, port)
        self._client.loop_start()

    def set(self, values: Mapping[Channel, float]) -> None:
        """See `PlcServer`."""
        messages = {
            topic_of(channel): json.dumps(bool(value) if channel.kind == 'digital' else float(value))
            for channel, value in values.items()
        }
        with self._setting:
            self._messages |= messages
            if self._client.is_connected():
                self._publish(messages)

    def _publish(self, messages: Mapping[str, str]) -> None:
        for topic, message in messages.items():
            self._client.publish(topic, message, QOS, retain=True)

    def _on_connect(self, client: Any, _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:
        if reason.is_failure:
            return
        if self._names:
            client.subscribe([(topic, QOS) for topic in self._names])
        with self._setting:
            self._publish(self._messages)

    def _on_message(self, _client: Any, _data: Any, message: Any) -> None:
        try:
            value = json.loads(message.payload)
            number = float(value) if isinstance(value, (int, float)) else math.nan
        except (ValueError, RecursionError, OverflowError):
            return
        if math.isfinite(number):
            self._on_written(self._names[message.topic], number)

    def close(self) -> None:
        """See `PlcServer`."""
        self._client.disconnect()
        self._client.loop_stop()


def topic_of(channel: Channel) -> str:
    """As plc/digital_input.1."""
    return f'{TOPIC}/{channel.name}'
