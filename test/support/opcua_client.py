"""A client of the robot's OPC UA server, which finds nodes by the names of the specifications."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

from asyncua import Client, ua
from asyncua.crypto.security_policies import SecurityPolicyBasic256Sha256

DI = 'http://opcfoundation.org/UA/DI/'
ROBOTICS = 'http://opcfoundation.org/UA/Robotics/'
CELL = 'urn:robots:cell'


async def as_client(
    url: str,
    work: Callable[[Nodes], Coroutine[Any, Any, Any]],
    *,
    user: str = '',
    password: str = '',
    application: str = '',
    files: tuple[str, str] | None = None,
) -> Any:
    """What a client finds out, which may be an application with files of its certificate and key."""
    client = Client(url, timeout=60.0)
    if user:
        client.set_user(user)
        client.set_password(password)
    if files is not None:
        client.application_uri = f'urn:{application}'
        await client.set_security(SecurityPolicyBasic256Sha256, *files)
    async with client:
        return await work(Nodes(client))


class Nodes:
    """Nodes by browse names; `di:`, `rob:` and `ua:` name namespaces, others are of the cell."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.indices: dict[str, int] = {}

    async def node(self, path: str) -> Any:
        if not self.indices:
            for name, uri in (('di', DI), ('rob', ROBOTICS), ('', CELL)):
                self.indices[name] = await self.client.get_namespace_index(uri)
        steps = [step.rpartition(':') for step in path.split('/')]
        names = [f'{self.indices.get(prefix, 0)}:{name}' for prefix, _, name in steps]
        return await self.client.nodes.objects.get_child(names)

    async def value(self, path: str) -> Any:
        return await (await self.node(path)).read_value()

    async def call(self, path: str, *arguments: Any) -> Any:
        parent, _, _ = path.rpartition('/')
        return await (await self.node(parent)).call_method((await self.node(path)).nodeid, *arguments)

    async def write(self, path: str, value: Any, kind: ua.VariantType) -> None:
        await (await self.node(path)).write_value(ua.DataValue(ua.Variant(value, kind)))
