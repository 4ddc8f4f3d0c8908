"""MqttLink: a connection to an MQTT broker, by paho-mqtt."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

from robots_controller.io.bridge.io_port import Arrival, Number
from robots_controller.io.bridge.place import Place
from robots_controller.io.plant.mqtt.mqtt_map import MqttServer
from robots_controller.io.plant.plant_link import LinkError, library
from robots_core.errors import InvalidInputError

CHECK_PERIOD: Final = 0.1  # s, how soon a connection that was lost is noticed
SHOWN: Final = 60
"""Letters of a message that is not understood."""


class MqttLink:
    """A connection to an MQTT broker; it subscribes to the topics of inputs.

    Args:
        server: The broker.
        inputs: Places to read.
        outputs: Places to write.

    Raises:
        InvalidInputError: paho-mqtt is not installed, or two outputs exclude each other in one message.
    """

    def __init__(self, server: MqttServer, inputs: Iterable[Any], outputs: Iterable[Any]) -> None:
        self._server = server
        self._library = library('paho.mqtt.client', 'paho-mqtt', 'mqtt')
        self._client: Any = None
        self._receive: Callable[[Iterable[Arrival]], None] = lambda _: None
        self._lost: str | None = None
        self._inputs = _by_topic(inputs)
        self._documents: dict[str, Any] = {}
        for topic, places in _by_topic(outputs).items():
            for n, place in enumerate(places):
                for other in places[:n]:
                    if place.pointer.excludes(other.pointer):
                        raise InvalidInputError(
                            f'{topic}: one message cannot hold {place.pointer.text!r} and '
                            f'{other.pointer.text!r}'
                        )

    def open(self, receive: Callable[[Iterable[Arrival]], None]) -> None:
        """Connect and subscribe."""
        server, self._receive, self._lost = self._server, receive, None
        client = self._client = self._made()
        answered, subscribed = threading.Event(), threading.Event()
        answers: list[Any] = []

        def on_connect(_client: Any, _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:
            answers.append(reason)
            answered.set()

        def on_subscribe(_client: Any, _data: Any, _mid: int, reasons: Any, _properties: Any) -> None:
            answers[1:] = reasons
            subscribed.set()

        client.on_connect, client.on_subscribe = on_connect, on_subscribe
        client.on_message, client.on_disconnect = self._on_message, self._on_disconnect
        client.connect_timeout = server.response_timeout
        try:
            client.connect(server.host, server.tcp_port, server.keepalive)
        except (OSError, ValueError) as error:
            raise LinkError(f'{server.host}:{server.tcp_port} cannot be reached: {error}') from error
        # Otherwise a message waits for the acknowledgement of the one before, 40 ms on many systems.
        client.socket().setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client.loop_start()
        self._wait(answered, 'connection')
        if answers[0].is_failure:
            raise LinkError(f'the broker refuses the connection: {answers[0]}')
        if not self._inputs:
            return
        client.subscribe(
            [(topic, max(place.qos for place in places)) for topic, places in self._inputs.items()]
        )
        self._wait(subscribed, 'subscription')
        for reason, (topic, places) in zip(answers[1:], self._inputs.items(), strict=True):
            if reason.is_failure:
                problem = f'{topic}: the broker refuses: {reason}'
                receive([Arrival(place, problem=problem) for place in places])

    def close(self) -> None:
        """Disconnect."""
        if self._client is not None:
            self._client.on_disconnect = None
            self._client.disconnect()
            self._client.loop_stop()
            self._client = None

    def read(self, now: float) -> float:
        """Check that the connection is there."""
        if self._lost is not None:
            raise LinkError(self._lost)
        return now + CHECK_PERIOD

    def write(self, values: Mapping[Any, Number]) -> Mapping[Place, str]:
        """Publish the messages that hold the values, and wait for their confirmations."""
        waiting = []
        for topic, places in _by_topic(values).items():
            document = self._documents.get(topic)
            for place in places:
                document = place.pointer.put(document, values[place])
            self._documents[topic] = document
            qos, retain = max(place.qos for place in places), any(place.retain for place in places)
            waiting.append(self._client.publish(topic, json.dumps(document), qos, retain))
        end = time.monotonic() + self._server.response_timeout
        for message in waiting:
            try:
                message.wait_for_publish(max(0.0, end - time.monotonic()))
            except (RuntimeError, ValueError) as error:
                raise LinkError(self._lost or str(error)) from error
            if not message.is_published():
                raise LinkError(self._lost or self._no_answer('message'))
        return {}

    def _made(self) -> Any:
        server, credentials = self._server, self._server.credentials
        made = self._library.Client(
            self._library.CallbackAPIVersion.VERSION2, client_id=server.client_id, reconnect_on_failure=False
        )
        if credentials.user:
            made.username_pw_set(credentials.user, credentials.password() or None)
        if server.tls:
            made.tls_set(
                credentials.trusted or None, credentials.certificate or None, credentials.key or None
            )
        return made

    def _wait(self, event: threading.Event, what: str) -> None:
        end = time.monotonic() + self._server.response_timeout
        while not event.wait(min(CHECK_PERIOD, max(0.0, end - time.monotonic()))):
            if self._lost is not None or time.monotonic() >= end:
                raise LinkError(self._lost or self._no_answer(what))

    def _no_answer(self, what: str) -> str:
        return f'the broker has not confirmed the {what} within {self._server.response_timeout:g} s'

    def _on_disconnect(self, _client: Any, _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:
        self._lost = f'the connection is lost: {reason}'

    def _on_message(self, _client: Any, _data: Any, message: Any) -> None:
        places = self._inputs.get(message.topic, [])
        try:
            document = json.loads(message.payload)
        except (ValueError, RecursionError):
            shown = message.payload[:SHOWN].decode(errors='replace')
            self._receive([Arrival(place, problem=f'{place.text}: {shown!r} is no JSON') for place in places])
            return
        self._receive([_arrival(place, document) for place in places])


def _arrival(place: Any, document: Any) -> Arrival:
    try:
        return Arrival(place, place.pointer.get(document))
    except InvalidInputError as error:
        return Arrival(place, problem=f'{place.topic}: {error.message}')


def _by_topic(places: Iterable[Any]) -> dict[str, list[Any]]:
    topics: dict[str, list[Any]] = {}
    for place in places:
        topics.setdefault(place.topic, []).append(place)
    return topics
