"""PlcServer: a PLC that a plant's protocol reaches, which has the robot's inputs and gets its outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Final, Protocol

from robots_controller.io.io_image import IMAGES, Channel, image_sizes
from robots_core.errors import InvalidInputError
from robots_core.free_port import free_port

LEAST: Final = 16
"""Channels of each kind, also if the script has less."""
HOST: Final = '127.0.0.1'

OnWritten = Callable[[str, float], None]
"""Takes the name of an output and the value that a client has written, in any thread."""


class PlcServer(Protocol):
    """A server, or a client of a broker; its channels are those of the robot.

    Args:
        channels: Those that the script has.
        port: TCP port of this machine, of the server or the broker.
        on_written: Takes what clients write.

    Raises:
        InvalidInputError: the protocol's library is not installed, or the server's port is taken.
    """

    def __init__(self, channels: Iterable[Channel], port: int, on_written: OnWritten) -> None: ...

    def set(self, values: Mapping[Channel, float]) -> None:
        """Give inputs of the robot values."""

    def close(self) -> None:
        """Disconnect all clients."""


def served_sizes(channels: Iterable[Channel]) -> dict[str, int]:
    """Number of channels of each image: up to the last that is used, and at least `LEAST`."""
    return dict.fromkeys(IMAGES, LEAST) | {
        image: max(LEAST, size) for image, size in image_sizes(channels).items()
    }


def check_port(protocol: str, port: int) -> None:
    """Check that a port of this machine is free.

    Raises:
        InvalidInputError: it is not.
    """
    if (free := free_port(HOST, port)) != port:
        raise InvalidInputError(f'port {port} is taken, {protocol} cannot be served there; {free} is free')
