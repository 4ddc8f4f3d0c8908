"""MQTT in an I/O map: brokers, values in the JSON messages of a topic, and the connection, by paho-mqtt."""

from __future__ import annotations

import json
import re
import socket
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final, Self

from robots_controller.io.bridge.io_port import Arrival, Number, Place, PlantPlace
from robots_controller.io.io_image import Channel
from robots_controller.io.number_kinds import read_kind
from robots_controller.io.plant.credentials import Credentials, read_credentials
from robots_controller.io.plant.plant_link import LinkError, library
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection

CHECK_PERIOD: Final = 0.1  # s, how soon a connection that was lost is noticed
SHOWN: Final = 60
"""Letters of a message that is not understood."""

_INDEX: Final = re.compile(r'0|[1-9][0-9]*')
_POINTER: Final = re.compile(r'(/([^~/]|~[01])*)*')


@dataclass(frozen=True)
class JsonPointer:
    """Where a value stands in a document: '' is all of it, '/press/force' and '/axes/0' are parts.

    Attributes:
        text: As it was written.
        steps: Names of members and indices of elements, from the outside in.
    """

    text: str
    steps: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> JsonPointer:
        """The pointer of a text.

        Raises:
            InvalidInputError: not a pointer.
        """
        if not _POINTER.fullmatch(text):
            raise InvalidInputError(
                f"{text!r} is no JSON pointer; pointers are like '', /force or /axes/0/force"
            )
        return cls(text, tuple(step.replace('~1', '/').replace('~0', '~') for step in text.split('/')[1:]))

    def get(self, document: Any) -> Any:
        """The value in a document.

        Raises:
            InvalidInputError: the document has no such member or element.
        """
        value = document
        for step in self.steps:
            if isinstance(value, dict) and step in value:
                value = value[step]
            elif isinstance(value, list) and _INDEX.fullmatch(step) and int(step) < len(value):
                value = value[int(step)]
            else:
                raise InvalidInputError(f'the message has no {step!r}, which {self.text} needs')
        return value

    def put(self, document: Any, value: Any) -> Any:
        """A document of members alone, with the value in it; the document itself where the pointer is ''."""
        if not self.steps:
            return value
        holder = document = document if isinstance(document, dict) else {}
        for step in self.steps[:-1]:
            holder = holder.setdefault(step, {})
        holder[self.steps[-1]] = value
        return document

    def excludes(self, other: JsonPointer) -> bool:
        """One of the two is a part of the other: a document of members cannot have both."""
        shorter = min(len(self.steps), len(other.steps))
        return self.steps[:shorter] == other.steps[:shorter]


@dataclass(frozen=True)
class MqttServer:
    """An MQTT broker.

    Attributes:
        port: As of its places.
        tls: The connection is encrypted.
        client_id: Identifies the client at the broker; '' for a random one.
        keepalive: How often the broker is asked for a sign of life, s.
        response_timeout: For connecting and for confirmations, s.
    """

    port: str
    host: str
    tcp_port: int
    tls: bool
    client_id: str
    credentials: Credentials
    keepalive: int
    response_timeout: float
    period: ClassVar[None] = None
    """Of inputs whose row has none: the broker speaks by itself."""

    @classmethod
    def read(cls, section: YamlSection, port: str) -> Self:
        """An entry of the section `mqtt`."""
        tls = section.switch('tls', default=False)
        made = cls(
            port,
            section.text('host'),
            section.whole('port', 8883 if tls else 1883, low=1, high=65535),
            tls,
            section.text('client_id', ''),
            read_credentials(section),
            section.whole('keepalive', 10, low=1, high=3600),
            section.number('response_timeout', 2.0, low=0.01, high=60.0),
        )
        for key in ('certificate', 'trusted'):
            if getattr(made.credentials, key) and not tls:
                raise section.error(f'{key} needs tls: true', key)
        return made

    def read_place(self, item: YamlSection, channel: Channel) -> MqttPlace:
        """The keys below `mqtt` of a row."""
        topic = item.text('topic')
        if not topic or any(letter in topic for letter in '+#\0'):
            raise item.error(f'{topic!r} is no topic; topics are like plant/press, without + and #', 'topic')
        output = channel.direction == 'output'
        if 'retain' in item and not output:
            raise item.error('retain is not for inputs', 'retain')
        return MqttPlace(
            self.port,
            read_kind(item, channel),
            topic,
            item.made('pointer', lambda value: JsonPointer.parse(str(value)))
            if 'pointer' in item
            else JsonPointer('', ()),
            item.whole('qos', 1, low=0, high=2),
            item.switch('retain', default=False),
        )

    def link(self, inputs: Mapping[Any, float], outputs: Iterable[Any]) -> MqttLink:
        """See `MqttLink`."""
        return MqttLink(self, inputs, outputs)


@dataclass(frozen=True)
class MqttPlace(PlantPlace):
    """A value in the JSON messages of a topic.

    Attributes:
        qos: Of subscriptions and of messages, 0 to 2.
        retain: The broker keeps the newest message for later subscribers.
    """

    topic: str
    pointer: JsonPointer
    qos: int
    retain: bool

    @property
    def source(self) -> str:
        """The topic: a broker that is there does not mean that its publisher is."""
        return f'{self.topic} of {self.port}'

    @property
    def text(self) -> str:
        """Topic and pointer."""
        return f'{self.topic} {self.pointer.text}'.rstrip()


class MqttLink:
    """A connection to an MQTT broker, which subscribes to the topics of inputs; see `PlantLink`.

    Raises:
        InvalidInputError: two outputs exclude each other in one message too.
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
