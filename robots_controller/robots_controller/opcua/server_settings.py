"""ServerSettings: who may do what at the robot's OPC UA server, and what it says of the robot; from YAML."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from robots_controller.io.plant.credentials import checked_file, existing_file, read_password
from robots_controller.io.plant.opcua import POLICIES
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection, read_yaml

SECURITY: Final = tuple(policy for policy in POLICIES if policy != 'none')
"""Policies that encrypt."""
LOOPBACK: Final = ('127.0.0.1', 'localhost', '::1')


@dataclass(frozen=True)
class ServerUser:
    """A user.

    Attributes:
        operate: May call methods and write outputs; otherwise it may read.
        password_file: Text file with the password in its first line; '' for a user with a certificate.
        certificate: File of the certificate that identifies the user; '' for a user with a password.
    """

    name: str
    operate: bool
    password_file: str = ''
    certificate: str = ''


@dataclass(frozen=True)
class Nameplate:
    """What the maker of the robot says of it; '' for what is not known."""

    manufacturer: str = ''
    model: str = ''
    serial_number: str = ''
    product_code: str = ''


@dataclass(frozen=True)
class ServerSettings:
    """Access to the server; by default anyone may read.

    Attributes:
        anonymous: Clients without a user may read.
        certificate: File of the server's certificate; '' for a server without encryption.
        key: File of its private key.
        security: Policies that encrypt, of `SECURITY`.
        trusted: Files of the certificates of clients; others are refused. Empty: all are taken.
    """

    anonymous: bool = True
    users: tuple[ServerUser, ...] = ()
    certificate: str = ''
    key: str = ''
    security: tuple[str, ...] = ()
    trusted: tuple[str, ...] = ()
    nameplate: Nameplate = field(default_factory=Nameplate)

    def check_host(self, host: str) -> None:
        """Check that nothing secret leaves this machine unencrypted.

        Raises:
            InvalidInputError: users with passwords, at another address than this machine's own, without a
                certificate.
        """
        if self.users and not self.certificate and host not in LOOPBACK:
            raise InvalidInputError(
                f'host {host!r} with users needs a certificate and its key: passwords would be sent in clear '
                f'text; without one, valid are {", ".join(LOOPBACK)}'
            )


def read_server_settings(path: Path | str) -> ServerSettings:
    """The settings of a file.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    section = read_yaml(path)
    users = tuple(_user(below, name) for below, name in section.entries('users'))
    certificate, key = existing_file(section, 'certificate'), existing_file(section, 'key')
    if bool(certificate) != bool(key):
        raise section.error('certificate and key need each other', 'certificate' if certificate else 'key')
    for name in ('security', 'trusted', 'users'):
        by_certificate = name != 'users' or any(user.certificate for user in users)
        if name in section and not certificate and by_certificate:
            raise section.error(f"{name} needs the server's certificate and key", name)
    made = ServerSettings(
        section.switch('anonymous', not users),
        users,
        certificate,
        key,
        _security(section) if certificate else (),
        tuple(checked_file(section, 'trusted', text) for text, _ in section.texts('trusted')),
        _nameplate(section),
    )
    section.finish()
    return made


def _user(below: YamlSection, name: str) -> ServerUser:
    entry = below.section(name)
    if entry is None:
        raise below.error(f'user {name} needs a password_file or a certificate', name)
    user = ServerUser(
        name,
        entry.switch('operate', default=False),
        existing_file(entry, 'password_file'),
        existing_file(entry, 'certificate'),
    )
    if bool(user.password_file) == bool(user.certificate):
        raise entry.error(f'user {name} needs one of password_file and certificate')
    if user.password_file and not read_password(user.password_file):
        raise entry.error(f'the first line of {user.password_file} is empty', 'password_file')
    return user


def _security(section: YamlSection) -> tuple[str, ...]:
    found = section.texts('security')
    for text, _ in found:
        if text not in SECURITY:
            raise section.error(f'unknown security {text!r}; valid are {", ".join(SECURITY)}', 'security')
    return tuple(text for text, _ in found) or SECURITY


def _nameplate(section: YamlSection) -> Nameplate:
    entry = section.section('nameplate')
    if entry is None:
        return Nameplate()
    return Nameplate(
        *(entry.text(key, '') for key in ('manufacturer', 'model', 'serial_number', 'product_code'))
    )
