"""PlantLink: one protocol's part of a connection to a plant."""

import logging
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from typing import Any, Protocol

from robots_controller.io.bridge.io_port import Arrival, Number, Place
from robots_core.errors import InvalidInputError, RobotsError


class LinkError(RobotsError):
    """The connection to a plant cannot be opened, or is lost."""

    code = 'R405'
    remedy = 'Check that the server or broker runs, and its address, user and certificates in the I/O map.'


class PlantLink(Protocol):
    """A connection that is opened, used and closed by one thread; all methods may block for a response time.

    `open`, `read` and `write` raise a LinkError where the partner cannot be reached or does not answer; the
    link is closed then, and opened again later.

    `PlantServer.link` makes it of the places to read, with their periods, s, and the places to write. That
    raises an InvalidInputError if the protocol's library is not installed.
    """

    def open(self, receive: Callable[[Iterable[Arrival]], None]) -> None:
        """Connect; `receive` takes what arrives from now on, in any thread."""

    def read(self, now: float) -> float:
        """Read what is due now, s of `time.monotonic`, and check that the partner is there.

        Returns:
            When to call again, s.
        """

    def write(self, values: Mapping[Place, Number]) -> Mapping[Place, str]:
        """Write values in their order, and wait until they are confirmed; those refused, and why."""

    def close(self) -> None:
        """End the connection, whether it is open or not."""


def library(module: str, package: str, protocol: str) -> Any:
    """A protocol's library.

    Raises:
        InvalidInputError: it is not installed.
    """
    # The connection reports the problem, once.
    logging.getLogger(module.partition('.')[0]).setLevel(logging.CRITICAL)
    try:
        return import_module(module)
    except ImportError as error:
        raise InvalidInputError(
            f'{protocol} needs the package {package}, which cannot be imported ({error}): '
            f'make plant-requirements, or pip install {package}'
        ) from None
