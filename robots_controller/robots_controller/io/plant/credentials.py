"""Users and certificates of a server, as an I/O map names them; secrets are in files of their own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from robots_core.errors import InvalidInputError
from robots_core.files.user_file import read_bytes, read_text
from robots_core.files.yaml_section import YamlSection

if TYPE_CHECKING:
    from cryptography import x509

MAX_CREDENTIAL: Final = 1_000_000
"""Of a certificate, a key or a password, bytes."""


@dataclass(frozen=True)
class Credentials:
    """Who we are, and how the other is known; '' for what is not needed.

    Attributes:
        password_file: Text file with the password in its first line.
        certificate: File of our own certificate.
        key: File of its private key.
        trusted: File of the certificate, or of its authority, that the server must have.
    """

    user: str = ''
    password_file: str = ''
    certificate: str = ''
    key: str = ''
    trusted: str = ''

    def password(self) -> str:
        """The password; '' for none.

        Raises:
            InvalidInputError: the file cannot be read.
        """
        return read_password(self.password_file) if self.password_file else ''


def read_credentials(section: YamlSection) -> Credentials:
    """The keys `user`, `password_file`, `certificate`, `key` and `trusted` of a server.

    Raises:
        InvalidInputError: half of a pair, or no such file; with file and line.
    """
    found = Credentials(
        section.text('user', ''),
        *(existing_file(section, key) for key in ('password_file', 'certificate', 'key', 'trusted')),
    )
    if found.password_file and not found.user:
        raise section.error('password_file needs a user', 'password_file')
    if bool(found.certificate) != bool(found.key):
        given = 'certificate' if found.certificate else 'key'
        raise section.error('certificate and key need each other', given)
    return found


def existing_file(section: YamlSection, key: str) -> str:
    """The path of a file that a key names; '' for none.

    Raises:
        InvalidInputError: there is no such file, or it cannot be read; with file and line.
    """
    path = section.text(key, '')
    return checked_file(section, key, path) if path else ''


def checked_file(section: YamlSection, key: str, path: str) -> str:
    """The path of a certificate, key or password file that can be read, `~` expanded.

    Raises:
        InvalidInputError: there is no such file, or it cannot be read; with file and line.
    """
    try:
        found = str(Path(path).expanduser())
        read_credential(found, key)
    except (InvalidInputError, RuntimeError) as error:  # RuntimeError: no such user's folder
        raise section.error(str(error), key) from None
    return found


def read_credential(path: Path | str, what: str) -> bytes:
    """The bytes of a certificate or key.

    Raises:
        InvalidInputError: the file cannot be read.
    """
    return read_bytes(path, what, largest=MAX_CREDENTIAL)


def read_password(path: Path | str) -> str:
    """The password in the first line of a file.

    Raises:
        InvalidInputError: the file cannot be read.
    """
    return read_text(path, 'password file', largest=MAX_CREDENTIAL).partition('\n')[0]


def load_certificate(path: Path | str) -> x509.Certificate:
    """A certificate, PEM or DER, by the package cryptography, which asyncua needs.

    Raises:
        InvalidInputError: the file cannot be read.
        ValueError: it is no certificate.
    """
    from cryptography import x509  # noqa: PLC0415  # maps without OPC UA work without it

    data = read_credential(path, 'certificate')
    return (x509.load_pem_x509_certificate if b'-----BEGIN' in data else x509.load_der_x509_certificate)(data)


def application_uri(path: Path | str) -> str:
    """The application of OPC UA that a certificate is of, '' for none; see `load_certificate`."""
    from cryptography import x509  # noqa: PLC0415

    try:
        names = load_certificate(path).extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return ''
    return str(next(iter(names.get_values_for_type(x509.UniformResourceIdentifier)), ''))
