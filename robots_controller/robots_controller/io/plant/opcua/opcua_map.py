"""OPC UA in an I/O map: servers, and variables as places."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from robots_controller.io.io_image import Channel
from robots_controller.io.number_kinds import read_kind
from robots_controller.io.plant.credentials import Credentials, read_credentials
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


@dataclass(frozen=True)
class OpcuaServer:
    """An OPC UA server.

    Attributes:
        name: As rows name it.
        endpoint: As opc.tcp://host:port/path.
        security: Policy, one of `POLICIES`.
        mode: One of `MODES`, where there is a policy.
        credentials: User and certificates.
        period: How often the server samples its variables and reports changes, s.
        response_timeout: For connecting and for each answer, s.
    """

    name: str
    endpoint: str
    security: str
    mode: str
    credentials: Credentials
    period: float
    response_timeout: float

    @property
    def port(self) -> str:
        """As of its places."""
        return f'opcua {self.name}'

    @property
    def polling(self) -> float:
        """Period of inputs whose row has none, s."""
        return self.period


@dataclass(frozen=True)
class OpcuaPlace:
    """A variable.

    Attributes:
        server: Name of the server.
        node: Its node id, as ns=2;s=Press.Ready, or with nsu=URI instead of the namespace's number.
        kind: Type of the number.
    """

    server: str
    node: str
    kind: str

    @property
    def port(self) -> str:
        """The server."""
        return f'opcua {self.server}'

    @property
    def source(self) -> str:
        """The server."""
        return self.port

    @property
    def text(self) -> str:
        """The node id."""
        return self.node

    @property
    def cells(self) -> tuple[str, ...]:
        """The variable."""
        return (self.node,)


def read_opcua_server(section: YamlSection, name: str) -> OpcuaServer:
    """An entry of the section `opcua`.

    Raises:
        InvalidInputError: a key is missing or not valid; with file and line.
    """
    endpoint = section.text('endpoint')
    if not re.fullmatch(r'opc\.tcp://[^/\s]+(/\S*)?', endpoint):
        raise section.error(f'{endpoint!r} is no endpoint; endpoints are like opc.tcp://plc:4840', 'endpoint')
    security = section.text('security', 'none', among=POLICIES)
    made = OpcuaServer(
        name,
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


def read_opcua_place(item: YamlSection, channel: Channel, server: OpcuaServer) -> OpcuaPlace:
    """The keys below `opcua` of a row.

    Raises:
        InvalidInputError: a key is missing or not valid; with file and line.
    """
    node = item.text('node')
    if not _NODE.fullmatch(node):
        raise item.error(f'{node!r} is no node id; they are like ns=2;s=Press.Ready or i=85', 'node')
    return OpcuaPlace(server.name, node, read_kind(item, channel))
