"""ServerAccess: who a client of the OPC UA server is, and which of its requests are served."""

from __future__ import annotations

import hmac
from collections.abc import Callable
from typing import Any, Final

from asyncua import ua
from asyncua.crypto.permission_rules import PermissionRuleset, User, UserRole
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding

from robots_controller.io.plant.credentials import load_certificate, read_password
from robots_controller.opcua.server_settings import ServerSettings, ServerUser
from robots_core.errors import InvalidInputError, RobotsError

READING: Final = frozenset(
    ua.NodeId(getattr(ua.ObjectIds, f'{name}Request_Encoding_DefaultBinary'))
    for name in (
        *('Read', 'Browse', 'BrowseNext', 'TranslateBrowsePathsToNodeIds', 'RegisterNodes'),
        *('UnregisterNodes', 'CreateSubscription', 'ModifySubscription', 'DeleteSubscriptions', 'Publish'),
        *('Republish', 'TransferSubscriptions', 'SetPublishingMode', 'CreateMonitoredItems'),
        *('ModifyMonitoredItems', 'DeleteMonitoredItems', 'SetMonitoringMode', 'CloseSession'),
        *('CloseSecureChannel', 'HistoryRead'),
    )
)
"""Requests that change nothing of the cell."""
OPERATING: Final = READING | {
    ua.NodeId(ua.ObjectIds.WriteRequest_Encoding_DefaultBinary),
    ua.NodeId(ua.ObjectIds.CallRequest_Encoding_DefaultBinary),
}


class _NoPermissions(PermissionRuleset):  # type: ignore[misc]  # asyncua has no types there
    def check_validity(self, user: Any, action_type_id: Any, body: Any) -> bool:
        """Nothing is served."""
        del user, action_type_id, body
        return False


NOBODY: Final = _NoPermissions()


class ServerAccess(PermissionRuleset):  # type: ignore[misc]
    """Known users and certificates; asyncua asks it. `log` gets who was refused, in any thread.

    Raises:
        InvalidInputError: a file that cannot be read.
    """

    def __init__(self, settings: ServerSettings, log: Callable[[str], object]) -> None:
        self._anonymous, self._log = settings.anonymous, log
        self._passwords = {
            user.name: (user, read_password(user.password_file))
            for user in settings.users
            if user.password_file
        }
        self._certificates = {_der(user.certificate): user for user in settings.users if user.certificate}
        self._trusted = {_der(path) for path in settings.trusted}

    @property
    def identity_tokens(self) -> list[type]:
        """How a client may say who it is."""
        tokens = {
            ua.AnonymousIdentityToken: self._anonymous or self._certificates,
            ua.UserNameIdentityToken: self._passwords,
            ua.X509IdentityToken: self._certificates,
        }
        return [token for token, used in tokens.items() if used]

    def get_user(
        self,
        _server: Any,
        username: str | None = None,
        password: str | None = None,
        certificate: bytes | None = None,
    ) -> User | None:
        """The user of a session; None refuses it."""
        if username is not None:
            known, expected = self._passwords.get(username, (None, ''))
            if known is None or not hmac.compare_digest(expected.encode(), (password or '').encode()):
                self._log(f'refused a client: user {username!r} is unknown, or its password is wrong')
                return None
            return _user(known)
        if (found := self._certificates.get(certificate or b'')) is not None:
            return _user(found)
        if not self._anonymous:
            self._log('refused a client without a user')
            return None
        return User(role=UserRole.Anonymous)

    def check_validity(self, user: Any, action_type_id: Any, body: Any) -> bool:
        """Whether a request of a user is served."""
        del body
        return action_type_id in (OPERATING if user.role is UserRole.User else READING)

    async def check_certificate(self, certificate: x509.Certificate, application: Any) -> None:
        """Refuse a client whose certificate is not trusted."""
        if self._trusted and certificate.public_bytes(Encoding.DER) not in self._trusted:
            self._log(f'refused a client: the certificate of {application.ApplicationUri} is not trusted')
            raise ua.UaStatusCodeError(ua.StatusCodes.BadCertificateUntrusted)


def _user(known: ServerUser) -> User:
    return User(role=UserRole.User if known.operate else UserRole.Anonymous, name=known.name)


def _der(path: str) -> bytes:
    try:
        return load_certificate(path).public_bytes(Encoding.DER)
    except RobotsError:
        raise
    except ValueError as error:
        raise InvalidInputError(
            f'certificate {path} cannot be read: {error}; valid are DER and PEM'
        ) from error
