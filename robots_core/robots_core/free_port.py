"""free_port: a port that a page can be served at."""

import contextlib
import socket
from typing import Final

from robots_core.errors import InvalidInputError

LAST_PORT: Final = 65535


def free_port(host: str, port: int) -> int:
    """The first free port at `host` from `port` on; 0: chosen by the system.

    Raises:
        InvalidInputError: a host that this machine does not have, or a port outside 0..65535.
    """
    if not 0 <= port <= LAST_PORT:
        raise InvalidInputError(f'port = {port} must be in [0, {LAST_PORT}]', port=port)
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        _bind(family, host, 0)
    except OSError as error:
        raise InvalidInputError(
            f'cannot serve at host {host!r} ({error.strerror or error}); valid are 127.0.0.1 (this machine '
            f'alone), 0.0.0.0 (the whole network) or an address of this machine',
            host=host,
        ) from error
    for candidate in range(port, LAST_PORT + 1):
        with contextlib.suppress(OSError):
            return _bind(family, host, candidate)
    raise InvalidInputError(f'no port from {port} to {LAST_PORT} is free at {host}', port=port)


def _bind(family: int, host: str, port: int) -> int:
    with socket.socket(family, socket.SOCK_STREAM) as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as the server does
        trial.bind((host, port))
        return int(trial.getsockname()[1])
