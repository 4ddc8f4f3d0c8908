"""FrameGuard: ends a connection whose server sends what is not OPC UA."""

from __future__ import annotations

import struct
from typing import Any, Final

TYPES: Final = (b'ACK', b'ERR', b'OPN', b'MSG', b'CLO', b'RHE')
CHUNKS: Final = b'FCA'
SIZES: Final = (8, 1 << 20)
"""Of a chunk with its header, bytes: the client asks for chunks of at most 64 KiB."""
HEADER: Final = struct.Struct('<3scI')


class FrameGuard:
    """Looks at the header of each chunk before asyncua does, which would wait for up to 4 GiB that it states.

    Attributes:
        refused: What the server has sent, '' as long as it is OPC UA.
    """

    def __init__(self) -> None:
        self.refused = ''

    def watch(self, client: Any) -> None:
        """Look at what a client of asyncua (its `UaClient`) receives from now on."""
        make = client._make_protocol  # noqa: SLF001

        def made() -> Any:
            protocol = make()
            take = protocol.data_received

            def data_received(data: bytes) -> None:
                if not self._refuses(protocol, data):
                    take(data)
                    self._refuses(protocol, b'')

            protocol.data_received = data_received
            return protocol

        client._make_protocol = made  # noqa: SLF001

    def _refuses(self, protocol: Any, data: bytes) -> bool:
        start = (protocol.receive_buffer or b'')[: HEADER.size] + data[: HEADER.size]
        self.refused = self.refused or wrong_header(start)
        if self.refused and protocol.transport is not None:
            protocol.transport.abort()
        return bool(self.refused)


def wrong_header(start: bytes) -> str:
    """Why a chunk cannot be OPC UA, as far as it has arrived; '' if it can."""
    if len(start) < HEADER.size:
        return ''
    kind, chunk, size = HEADER.unpack_from(start)
    low, high = SIZES
    if kind in TYPES and chunk in CHUNKS and low <= size <= high:
        return ''
    return f'sends what is not OPC UA, beginning with {start[: HEADER.size]!r}'
