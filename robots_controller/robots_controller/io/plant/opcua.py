"""OPC UA in an I/O map: servers, variables as places, and the connection, by asyncua."""

from __future__ import annotations

import concurrent.futures
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, Final, Self

from robots_controller.io.bridge.io_port import Arrival, Number, Place, PlantPlace
from robots_controller.io.io_image import Channel
from robots_controller.io.number_kinds import read_kind
from robots_controller.io.plant.credentials import (
    Credentials,
    application_uri,
    read_credential,
    read_credentials,
)
from robots_controller.io.plant.opcua_frames import FrameGuard
from robots_controller.io.plant.plant_link import LinkError, library
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection

POLICIES: Final = {
    'none': '',
    'basic256sha256': 'SecurityPolicyBasic256Sha256',
    'aes128_sha256_rsaoaep': 'SecurityPolicyAes128Sha256RsaOaep',
    'aes256_sha256_rsapss': 'SecurityPolicyAes256Sha256RsaPss',
}
"""Names of asyncua's classes, by the names that maps have for the policies."""
MODES: Final = {'sign_and_encrypt': 'SignAndEncrypt', 'sign': 'Sign'}

_NODE: Final = re.compile(r'((ns=\d{1,5}|nsu=[^;]+);)?(i=\d{1,10}|[sgb]=.+)')

MOST_NODES: Final = 500
"""Of a request: what small servers take."""
QUEUE: Final = 10
"""Changes of a variable that the server keeps between two messages."""
SHORTEST_CHECK: Final = 0.05  # s
SEVERITY: Final = 0xC000_0000
CODE: Final = 0xFFFF_0000
INFO_TYPE: Final = 0x0000_0C00
DATA_VALUE: Final = 0x0000_0400
OVERFLOW: Final = 0x0000_0080
"""Bits of a status (OPC 10000-4): good if none of the severity is set; `OVERFLOW` is of data values."""

VARIANTS: Final = {
    'boolean': 'Boolean',
    'int8': 'SByte',
    'uint8': 'Byte',
    **{f'{sign}int{size}': f'{sign.upper()}Int{size}' for sign in ('', 'u') for size in (16, 32, 64)},
    'float': 'Float',
    'double': 'Double',
}


@dataclass(frozen=True)
class OpcuaServer:
    """An OPC UA server.

    Attributes:
        port: As of its places.
        endpoint: As opc.tcp://host:port/path.
        security: Policy, one of `POLICIES`.
        mode: One of `MODES`, where there is a policy.
        period: How often the server samples its variables and reports changes, s.
        response_timeout: For connecting and for each answer, s.
    """

    port: str
    endpoint: str
    security: str
    mode: str
    credentials: Credentials
    period: float
    response_timeout: float

    @classmethod
    def read(cls, section: YamlSection, port: str) -> Self:
        """An entry of the section `opcua`."""
        endpoint = section.text('endpoint')
        if not re.fullmatch(r'opc\.tcp://[^/\s]+(/\S*)?', endpoint):
            raise section.error(
                f'{endpoint!r} is no endpoint; endpoints are like opc.tcp://plc:4840', 'endpoint'
            )
        security = section.text('security', 'none', among=POLICIES)
        made = cls(
            port,
            endpoint,
            security,
            section.text('mode', 'sign_and_encrypt', among=MODES),
            read_credentials(section),
            section.number('period', 0.1, low=0.001, high=3600.0),
            section.number('response_timeout', 4.0, low=0.01, high=60.0),
        )
        if security != 'none' and not made.credentials.certificate:
            raise section.error(f'security {security} needs a certificate and its key', 'security')
        if security == 'none':
            for key in ('mode', 'certificate', 'trusted'):
                if key in section:
                    raise section.error(f'{key} needs a security other than none', key)
        return made

    def read_place(self, item: YamlSection, channel: Channel) -> OpcuaPlace:
        """The keys below `opcua` of a row."""
        node = item.text('node')
        if not _NODE.fullmatch(node):
            raise item.error(f'{node!r} is no node id; they are like ns=2;s=Press.Ready or i=85', 'node')
        return OpcuaPlace(self.port, read_kind(item, channel), node)

    def link(self, inputs: Mapping[Any, float], outputs: Iterable[Any]) -> OpcuaLink:
        """See `OpcuaLink`."""
        return OpcuaLink(self, inputs, outputs)


@dataclass(frozen=True)
class OpcuaPlace(PlantPlace):
    """A variable.

    Attributes:
        node: Its node id, as ns=2;s=Press.Ready, or with nsu=URI instead of the namespace's number.
    """

    node: str

    @property
    def text(self) -> str:
        """The node id."""
        return self.node


class OpcuaLink:
    """A connection to an OPC UA server, which reports changes of the inputs' variables; see `PlantLink`."""

    def __init__(self, server: OpcuaServer, inputs: Mapping[Any, float], outputs: Iterable[Any]) -> None:
        self._server = server
        self._ua = library('asyncua', 'asyncua', 'opcua').ua
        self._sync = library('asyncua.sync', 'asyncua', 'opcua')
        self._client: Any = None
        self._inputs, self._outputs = inputs, list(outputs)
        self._nodes: dict[Any, Any] = {}
        self._receive: Callable[[Iterable[Arrival]], None] = lambda _: None
        self._received: dict[Any, Arrival] = {}
        """The newest of each place; from the thread of asyncua alone after the connection is open."""
        self._ended = ''
        self._frames = FrameGuard()

    def open(self, receive: Callable[[Iterable[Arrival]], None]) -> None:
        """Connect and subscribe."""
        server, self._receive, self._received, self._ended = self._server, receive, {}, ''
        with self._answering():
            # The client's own waiting ends after that of its requests.
            self._client = self._sync.Client(
                server.endpoint,
                timeout=server.response_timeout,
                sync_wrapper_timeout=4 * server.response_timeout,
                watchdog_intervall=server.response_timeout,
            )
            self._frames = FrameGuard()
            self._frames.watch(self._client.aio_obj)
            self._secure()
            self._client.connect()
            self._nodes = {
                place: self._client.get_node(self._id(place)) for place in (*self._inputs, *self._outputs)
            }
            if not self._inputs:
                return
            subscription = self._client.create_subscription(1e3 * server.period, self)
            self._places: dict[Any, list[Any]] = {}
            for place in self._inputs:
                self._places.setdefault(self._nodes[place].nodeid, []).append(place)
            for period in sorted(set(self._inputs.values())):
                for places in _chunks(place for place in self._inputs if self._inputs[place] == period):
                    answers = subscription.subscribe_data_change(
                        [self._nodes[place] for place in places],
                        queuesize=QUEUE,
                        sampling_interval=1e3 * period,
                    )
                    for place, answer in zip(places, answers, strict=True):
                        if isinstance(answer, self._ua.StatusCode):
                            self._take(Arrival(place, problem=f'{place.text}: {answer.name}'))

    def close(self) -> None:
        """Disconnect."""
        client, self._client = self._client, None
        if client is not None:
            with suppress(Exception):  # of a connection that is lost
                client.disconnect()
            with suppress(Exception):  # ended by `disconnect` before
                client.tloop.stop()

    def read(self, now: float) -> float:
        """Check that the server answers: variables of which no change has arrived are as they were then."""
        if self._ended:
            raise LinkError(self._ended)
        with self._answering():
            self._client.nodes.server_state.read_value()
            if self._received:
                self._client.tloop.post(self._receive_again())
        return now + max(self._server.period, SHORTEST_CHECK)

    def write(self, values: Mapping[Any, Number]) -> Mapping[Place, str]:
        """Write variables; those that the server refuses, and why."""
        refused: dict[Place, str] = {}
        for places in _chunks(values):
            with self._answering():
                answers = self._client.write_values(
                    [self._nodes[place] for place in places],
                    [self._value(place, values[place]) for place in places],
                    raise_on_partial_error=False,
                )
            for place, answer in zip(places, answers, strict=True):
                if not answer.is_good():
                    refused[place] = answer.name
        return refused

    def datachange_notification(self, node: Any, _value: Any, data: Any) -> None:
        """A variable has changed; called by asyncua in its thread."""
        found = data.monitored_item.Value
        stamp = math.nan if found.SourceTimestamp is None else found.SourceTimestamp.timestamp()
        code = 0 if found.StatusCode is None else found.StatusCode.value
        # The server says that its queue was full, not how much it has dropped.
        lost = int(code & OVERFLOW == OVERFLOW and code & INFO_TYPE == DATA_VALUE)
        for place in self._places.get(node.nodeid, ()):
            if code & SEVERITY:
                name = self._ua.StatusCode(code & CODE).name
                self._take(Arrival(place, problem=f'{place.text}: {name}', lost=lost))
            else:
                value = None if found.Value is None else found.Value.Value
                self._take(Arrival(place, value, stamp=stamp, lost=lost))
            lost = 0

    def status_change_notification(self, change: Any) -> None:
        """The subscription has ended or is about to; called by asyncua in its thread."""
        if not change.Status.is_good():
            self._ended = f'the subscription has ended: {change.Status.name}'

    def _take(self, arrival: Arrival) -> None:
        self._received[arrival.place] = replace(arrival, lost=0) if arrival.lost else arrival
        self._receive([arrival])

    async def _receive_again(self) -> None:
        self._receive([arrival for arrival in self._received.values() if not arrival.problem])

    def _value(self, place: Any, value: Number) -> Any:
        # Without time stamps: many servers let nobody else write those.
        return self._ua.DataValue(self._ua.Variant(value, self._ua.VariantType[VARIANTS[place.kind]]))

    def _id(self, place: Any) -> str:
        match = re.match(r'nsu=([^;]+);', place.node)
        if match is None:
            return str(place.node)
        try:
            index = self._client.get_namespace_index(match[1])
        except ValueError:
            raise LinkError(f'{place.text}: the server has no namespace {match[1]}') from None
        return f'ns={index};{place.node[match.end() :]}'

    def _secure(self) -> None:
        server, credentials, client = self._server, self._server.credentials, self._client
        if credentials.user:
            client.set_user(credentials.user)
            client.set_password(credentials.password())
        if server.security == 'none':
            return
        policies = library('asyncua.crypto.security_policies', 'asyncua', 'opcua')
        for path, what in ((credentials.key, 'key'), (credentials.trusted, 'trusted certificate')):
            if path:
                read_credential(path, what)
        client.application_uri = application_uri(credentials.certificate)
        client.tloop.post(
            client.aio_obj.set_security(
                getattr(policies, POLICIES[server.security]),
                credentials.certificate,
                credentials.key,
                server_certificate=credentials.trusted or None,
                mode=self._ua.MessageSecurityMode[MODES[server.mode]],
            )
        )

    @contextmanager
    def _answering(self) -> Iterator[None]:
        try:
            yield
        except (TimeoutError, concurrent.futures.TimeoutError) as error:
            raise LinkError(f'no answer within {self._server.response_timeout:g} s') from error
        except InvalidInputError as error:
            raise LinkError(error.message) from error
        except (OSError, self._ua.UaError) as error:
            reason = self._frames.refused or str(error).strip() or type(error).__name__
            raise LinkError(f'{self._server.endpoint}: {reason}') from error


def _chunks(places: Iterable[Any]) -> Iterator[list[Any]]:
    rest = iter(places)
    while chunk := list(islice(rest, MOST_NODES)):
        yield chunk
