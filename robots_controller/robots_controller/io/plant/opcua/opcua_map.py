"""OPC UA in an I/O map: servers, and variables as places."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final, Self

from robots_controller.io.bridge.place import PlantPlace
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
        port: As of its places.
        endpoint: As opc.tcp://host:port/path.
        security: Policy, one of `POLICIES`.
        mode: One of `MODES`, where there is a policy.
        credentials: User and certificates.
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
        """An entry of the section `opcua`.

        Raises:
            InvalidInputError: a key is missing or not valid; with file and line.
        """
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
        """The keys below `opcua` of a row.

        Raises:
            InvalidInputError: a key is missing or not valid; with file and line.
        """
        node = item.text('node')
        if not _NODE.fullmatch(node):
            raise item.error(f'{node!r} is no node id; they are like ns=2;s=Press.Ready or i=85', 'node')
        return OpcuaPlace(self.port, read_kind(item, channel), node)


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
