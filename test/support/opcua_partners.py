"""An OPC UA server for tests, as asyncua makes it, in a thread of this process."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from asyncua import server as opcua
from asyncua import ua
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from asyncua.crypto.permission_rules import User, UserRole
from asyncua.server.internal_subscription import InternalSubscription
from cryptography.x509.oid import ExtendedKeyUsageOID

from plant_partners import Partner, free_port
from robots_core.garbage import garbage_kept


def certificate(folder: Path, name: str) -> tuple[str, str]:
    """Files of a self-signed certificate of an application and its key."""
    key, made = folder / f'{name}.pem', folder / f'{name}.der'
    use = [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH]
    asyncio.run(
        setup_self_signed_certificate(key, made, f'urn:{name}', 'localhost', use, {'commonName': name})
    )
    return str(made), str(key)


class OverflowMarks:
    """Marks what servers of asyncua send after values that their queues have dropped, as OPC 10000-4 has it.

    asyncua drops them without a mark.
    """

    OVERFLOW = ua.StatusCode(0x0480)

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.count = 0
        """Of values that were dropped."""
        self._plain = InternalSubscription._enqueue_event
        monkeypatch.setattr(InternalSubscription, '_enqueue_event', self._marking())

    def _marking(self) -> Any:
        async def enqueue(subscription: Any, item: int, event: Any, size: int, queue: dict[int, Any]) -> None:
            full = 0 < size <= len(queue.get(item, ()))
            await self._plain(subscription, item, event, size, queue)
            if full:
                self.count += 1
                oldest = queue[item][0]
                value = replace(oldest.Value, StatusCode=self.OVERFLOW)
                queue[item][0] = replace(oldest, Value=value)

        return enqueue


class OpcuaPartner(Partner):
    """An OPC UA server of asyncua, with variables of a namespace of its own.

    To make it takes seconds: it stops and starts with the same variables. Whoever does without encryption is
    let in; users and applications that it does not know are not.

    Args:
        variables: Values by name; an int is an Int32.
        certificate: Files of its certificate and key.
        users: Passwords by name.
        strangers: Applications whose certificates it does not trust.
    """

    NAMESPACE = 'urn:robots:press'

    def __init__(
        self,
        variables: dict[str, Any],
        certificate: tuple[str, str],
        users: dict[str, str],
        strangers: tuple[str, ...] = (),
    ) -> None:
        super().__init__()
        self.port = free_port()
        self.endpoint = f'opc.tcp://127.0.0.1:{self.port}'
        self._users, self._strangers = users, strangers
        self._nodes: dict[str, Any] = {}
        self._server = self.call(self._made(variables, certificate))
        self._listens = False

    async def _made(self, variables: dict[str, Any], certificate: tuple[str, str]) -> Any:
        server = opcua.Server(user_manager=self)
        with garbage_kept():
            await server.init()
        server.set_endpoint(self.endpoint)
        await server.load_certificate(certificate[0])
        await server.load_private_key(certificate[1])
        policies = ua.SecurityPolicyType
        server.set_security_policy([policies.NoSecurity, policies.Basic256Sha256_SignAndEncrypt])
        server.set_certificate_validator(self._look_at_certificate)
        index = await server.register_namespace(self.NAMESPACE)
        for name, value in variables.items():
            kind = ua.VariantType.Int32 if type(value) is int else None
            node = await server.nodes.objects.add_variable(ua.NodeId(name, index), name, value, kind)
            await node.set_writable()
            self._nodes[name] = node
        await server.start()
        await server.bserver.stop()
        return server

    async def _start(self) -> None:
        await self._server.bserver.start()
        self._listens = True

    async def _stop(self) -> None:
        if self._listens:
            await self._server.bserver.stop()
            self._listens = False

    def end(self) -> None:
        """End the server and its thread."""
        self.stop()
        self.call(self._server.iserver.stop())
        super().end()

    def get_user(self, _server: Any, username: str = '', password: str = '', **_: Any) -> User | None:
        """Of a client; None refuses it."""
        known = not username or self._users.get(username) == password
        return User(role=UserRole.User) if known else None

    async def _look_at_certificate(self, _certificate: Any, application: Any) -> None:
        if application.ApplicationUri in self._strangers:
            raise ua.UaStatusCodeError(ua.StatusCodes.BadCertificateUntrusted)

    def set(self, name: str, value: Any) -> None:
        """Set a variable."""
        self.call(self._nodes[name].write_value(value))

    def get(self, name: str) -> Any:
        """Value of a variable."""
        return self.call(self._nodes[name].read_value())

    def flood(self, name: str, values: Sequence[Any]) -> None:
        """Set a variable to one value after the other before the server sends any."""
        self.call(self._flood(self._nodes[name], values))

    @staticmethod
    async def _flood(node: Any, values: Sequence[Any]) -> None:
        for value in values:
            await node.write_value(value)

    def end_subscriptions(self) -> None:
        """Inform all clients that their subscriptions have timed out."""
        self.call(self._end_subscriptions())

    async def _end_subscriptions(self) -> None:
        for subscription in self._server.iserver.subscription_service.subscriptions.values():
            await subscription.enqueue_statuschange(ua.StatusCode(ua.StatusCodes.BadTimeout))

    def protect(self, name: str, *, writable: bool) -> None:
        """Let clients write a variable, or not."""
        self.call(self._nodes[name].set_writable(writable))
