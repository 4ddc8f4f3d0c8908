"""MQTT in an I/O map: brokers, and values inside the JSON messages of a topic as places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

from robots_controller.io.bridge.place import PlantPlace
from robots_controller.io.io_image import Channel
from robots_controller.io.number_kinds import read_kind
from robots_controller.io.plant.credentials import Credentials, read_credentials
from robots_controller.io.plant.json_pointer import JsonPointer
from robots_core.files.yaml_section import YamlSection


@dataclass(frozen=True)
class MqttServer:
    """An MQTT broker.

    Attributes:
        port: As of its places.
        host: Its address.
        tcp_port: Its port.
        tls: The connection is encrypted.
        client_id: Identifies the client at the broker; '' for a random one.
        credentials: User and certificates.
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
        """An entry of the section `mqtt`.

        Raises:
            InvalidInputError: a key is missing or not valid; with file and line.
        """
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
        """The keys below `mqtt` of a row.

        Raises:
            InvalidInputError: a key is missing or not valid; with file and line.
        """
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


@dataclass(frozen=True)
class MqttPlace(PlantPlace):
    """A value in the JSON messages of a topic.

    Attributes:
        topic: The topic.
        pointer: The value in its messages.
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
