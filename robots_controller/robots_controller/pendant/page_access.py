"""PageAccess: where the operator's page is served, and the password that protects it."""

from __future__ import annotations

import ipaddress
import os
import stat
from collections import OrderedDict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.files.user_file import read_text

THIS_MACHINE: Final = '127.0.0.1'
SHORTEST_PASSWORD: Final = 8
LARGEST_FILE: Final = 4096  # bytes
OTHERS: Final = stat.S_IRWXG | stat.S_IRWXO
FIRST_DELAY: Final = 1.0  # s after a wrong password, in which its address is refused
LONGEST_DELAY: Final = 60.0  # s
FORGOTTEN_AFTER: Final = 600.0  # s
MOST_ADDRESSES: Final = 1000
NETWORK_BITS: Final = 64  # of an IPv6 address: one machine has all addresses below


@dataclass(frozen=True)
class PageAccess:
    """Where the page is served, and to whom.

    Attributes:
        host: Address to listen at.
        password: What a viewer must give; '' for nothing, on this machine alone.
    """

    host: str = THIS_MACHINE
    password: str = field(default='', repr=False)


def read_access(host: str = THIS_MACHINE, password_file: str = '') -> PageAccess:
    """The access that a host and a password file describe.

    Args:
        host: Address to listen at; '' for this machine alone.
        password_file: Its first line is the password; '' for none.

    Raises:
        InvalidInputError: other machines are served without a password, or the password is too short.
        UnreadableFileError: there is no such file, or it is none.
    """
    host = host or THIS_MACHINE
    if password_file:
        return PageAccess(host, _read_password(password_file))
    if not is_this_machine(host):
        raise InvalidInputError(
            f"host = {host!r} serves the operator's page to other machines; this needs a password "
            f'(--password-file, or the parameter password_file), or host {THIS_MACHINE}'
        )
    return PageAccess(host)


def is_this_machine(host: str) -> bool:
    """Only this machine reaches a host."""
    try:
        return ipaddress.ip_address(host.strip('[]')).is_loopback
    except ValueError:
        return host.lower() == 'localhost'


def _read_password(path: str) -> str:
    password = read_text(path, 'password file', largest=LARGEST_FILE).partition('\n')[0].rstrip('\r')
    found = Path(path).stat()
    if found.st_mode & OTHERS or found.st_uid not in (os.getuid(), 0):
        raise InvalidInputError(
            f'the password file {path} is open to others than its user (mode {found.st_mode & 0o777:o}, '
            f'user {found.st_uid}); make it your own: chmod 600 {path}'
        )
    if len(password) < SHORTEST_PASSWORD:
        raise InvalidInputError(
            f'the first line of the password file {path} has {len(password)} characters; '
            f'a password has at least {SHORTEST_PASSWORD}'
        )
    return password


class LoginAttempts:
    """Delays who gives wrong passwords: each wrong one doubles the time for which its address is refused."""

    def __init__(self) -> None:
        self._wrong: OrderedDict[str, tuple[int, float]] = OrderedDict()  # how many, and when the last, s

    def delay(self, address: str, now: float) -> float:
        """Time until an IP address may try again, s; 0: now."""
        count, last = self._of(address, now)
        delay = min(LONGEST_DELAY, FIRST_DELAY * 2.0 ** (count - 1)) if count else 0.0
        return max(0.0, last + delay - now)

    def wrong(self, address: str, now: float) -> None:
        """An address has given a wrong password."""
        key, (count, _) = _network(address), self._of(address, now)
        self._wrong[key] = count + 1, now
        self._wrong.move_to_end(key)
        while len(self._wrong) > MOST_ADDRESSES:
            self._wrong.popitem(last=False)

    def right(self, address: str) -> None:
        """An address has given the right password."""
        self._wrong.pop(_network(address), None)

    def _of(self, address: str, now: float) -> tuple[int, float]:
        count, last = self._wrong.get(_network(address), (0, now))
        return (0, now) if now - last > FORGOTTEN_AFTER else (min(count, 10), last)


def _network(address: str) -> str:
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    return str(ipaddress.ip_network((found, NETWORK_BITS), strict=False)) if found.version == 6 else address
