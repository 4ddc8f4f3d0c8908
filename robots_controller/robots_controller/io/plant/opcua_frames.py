"""Ends connections whose partner sends what is not OPC UA, or more than it may: of clients and of servers."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, Final

TYPES: Final = (b'HEL', b'ACK', b'ERR', b'OPN', b'MSG', b'CLO', b'RHE')
CHUNKS: Final = b'FCA'
SIZES: Final = (8, 1 << 20)
"""Of a chunk with its header, bytes: both sides ask for chunks of at most 64 KiB."""
LONGEST: Final = 16 << 20
"""Of a message with all its chunks, bytes."""
MOST_CHUNKS: Final = 2048
"""Of a message; a chunk that is not the last has 8 KiB by the protocol."""
HEADER: Final = struct.Struct('<3scI')


class FrameGuard:
    """Looks at the header of each chunk before asyncua does, which would wait for up to 4 GiB that it states.

    Bounds messages too: asyncua takes the limits that the server states, or none.

    Attributes:
        refused: What the server has sent, '' as long as it is OPC UA within the limits.
    """

    def __init__(self) -> None:
        self.refused = ''

    def watch(self, client: Any) -> None:
        """Look at what a client of asyncua (`Client`, not its synchronous one) receives from now on."""
        client.max_messagesize, client.max_chunkcount = LONGEST, MOST_CHUNKS  # as the server is asked for
        _guard(client.uaclient, self._refusal)

    def _refusal(self, protocol: Any, data: bytes) -> str:
        start = (protocol.receive_buffer or b'')[: HEADER.size] + data[: HEADER.size]
        self.refused = self.refused or wrong_header(start) or _too_long(protocol._connection)  # noqa: SLF001
        return self.refused


async def start_guarded(server: Any) -> None:
    """Start a server of asyncua, which by itself would wait for up to 4 GiB of each client."""
    server.limits.max_message_size, server.limits.max_chunk_count = LONGEST, MOST_CHUNKS
    await server.start()
    # What makes its connections exists now, and listens already.
    await server.bserver.stop()
    _guard(server.bserver, _refusal)
    await server.bserver.start()


def _refusal(protocol: Any, data: bytes) -> str:
    return wrong_header(protocol._buffer[: HEADER.size] + data[: HEADER.size])  # noqa: SLF001


def _guard(maker: Any, refusal: Callable[[Any, bytes], str]) -> None:
    """Abort connections, which `maker` makes, as soon as what they receive is refused with a reason."""
    make = maker._make_protocol  # noqa: SLF001

    def made() -> Any:
        protocol = make()
        take = protocol.data_received

        def refuses(data: bytes) -> bool:
            refused = bool(refusal(protocol, data))
            if refused and protocol.transport is not None:
                protocol.transport.abort()
            return refused

        def data_received(data: bytes) -> None:
            if not refuses(data):
                take(data)
                refuses(b'')

        protocol.data_received = data_received
        return protocol

    maker._make_protocol = made  # noqa: SLF001


def wrong_header(start: bytes) -> str:
    """Why a chunk cannot be OPC UA, as far as it has arrived; '' if it can."""
    if len(start) < HEADER.size:
        return ''
    kind, chunk, size = HEADER.unpack_from(start)
    low, high = SIZES
    if kind in TYPES and chunk in CHUNKS and low <= size <= high:
        return ''
    return f'sends what is not OPC UA, beginning with {start[: HEADER.size]!r}'


def _too_long(connection: Any) -> str:
    size, chunks = connection._incoming_size, len(connection._incoming_parts)  # noqa: SLF001
    if size <= LONGEST and chunks <= MOST_CHUNKS:
        return ''
    return f'sends a message of more than {LONGEST >> 20} MiB or {MOST_CHUNKS} chunks'
