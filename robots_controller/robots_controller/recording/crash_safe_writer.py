"""CrashSafeWriter: an MCAP bag that is whole at any time, so that a kill loses its last second alone."""

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter

BAG_VERSION: Final = 9
CHUNK_SIZE: Final = 1_000_000  # bytes; below the 2**20 at which the base class writes a chunk
MESSAGE_OPCODE: Final = 0x05
# Of MCAP's record of a message, which begins with its opcode and its length.
MESSAGE_HEAD: Final = (('opcode', 'u1'), ('length', '<u8'))
MESSAGE_FIELDS: Final = (
    ('channel', '<u2'),
    ('sequence', '<u4'),
    ('log_time', '<u8'),
    ('publish_time', '<u8'),
)


class _LastingMcap(McapWriter):
    """Writes the file's end after every flush, and goes on over it."""

    def close(self, version: int, metadata: str) -> None:
        """Write what has come and the end of the file; more may follow."""
        file, tail = self.bio, _Tail(self.bio.tell())
        self.bio = tail  # type: ignore[assignment]  # all that the base class does is write and tell
        try:
            if self.chunk.bio.tell():
                self.close_chunk()
            length = tail.tell()
            super().close(version, metadata)
        finally:
            self.bio = file
        # In one piece: a kill hits between two writes, hardly ever inside one.
        file.write(tail.getvalue())
        file.flush()
        file.seek(length)

    def write_rows(self, channel: int, times: NDArray[np.int64], rows: NDArray[np.uint8]) -> None:
        """Write messages of one length as `write` would do one by one."""
        record = np.dtype([*MESSAGE_HEAD, *MESSAGE_FIELDS, ('data', 'u1', (rows.shape[1],))])
        records = np.zeros(len(times), record)
        records['opcode'] = MESSAGE_OPCODE
        records['length'] = record.itemsize - np.dtype(list(MESSAGE_HEAD)).itemsize
        records['channel'] = channel
        records['log_time'] = records['publish_time'] = times
        records['data'] = rows
        first, last = int(times[0]), int(times[-1])
        chunk = self.chunk
        offsets = range(chunk.bio.tell(), chunk.bio.tell() + records.nbytes, record.itemsize)
        chunk.msgs[channel].extend(zip(times.tolist(), offsets, strict=True))
        chunk.bio.write(records.tobytes())
        chunk.message_start_time = min(first, chunk.message_start_time)
        chunk.message_end_time = max(last, chunk.message_end_time)
        self.message_start_time = min(first, self.message_start_time)
        self.message_end_time = max(last, self.message_end_time)
        self.channel_stats[channel] += len(times)

    def finish(self) -> None:
        """Close the file."""
        self.bio.close()


class _Tail(BytesIO):
    """What will stand in the file from an offset on; positions are those in the file."""

    def __init__(self, offset: int) -> None:
        super().__init__()
        self._offset = offset

    def tell(self) -> int:
        return self._offset + super().tell()

    def close(self) -> None:
        """Stay: the content is still needed."""


class CrashSafeWriter(Writer):
    """A rosbag2 writer (MCAP) with a bag that any reader can open after each `flush`, whatever happens then.

    Args:
        path: Folder of the bag; must not exist.
        chunks: It flushes by itself after so many chunks of about a megabyte.
    """

    STORAGE_PLUGINS: Mapping[Any, Any] = MappingProxyType({StoragePlugin.MCAP: _LastingMcap})

    def __init__(self, path: Path, *, chunks: int = 1) -> None:
        super().__init__(path, version=BAG_VERSION, storage_plugin=StoragePlugin.MCAP)
        self._chunks = chunks

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Take a message; it stays in memory until there are many, or until `flush`."""
        storage: Any = self.storage
        if storage.chunk.bio.tell() + len(data) > CHUNK_SIZE:
            self._end_chunk()  # before the base class does: it writes chunks without the file's end
        super().write(connection, timestamp, data)

    def write_rows(
        self, connection: Connection, timestamps: NDArray[np.int64], rows: NDArray[np.uint8]
    ) -> None:
        """Take messages of one length at once; as `write` for each, in a fraction of the time.

        Args:
            connection: Their topic.
            timestamps: (k,) ns, in order.
            rows: (k, size) bytes.
        """
        storage: Any = self.storage
        # Whole rows at a time, so that a chunk never comes near the size at which the base class writes it.
        step = max(1, CHUNK_SIZE // (4 * (rows.shape[1] + 64)))
        for start in range(0, len(timestamps), step):
            part = slice(start, start + step)
            if storage.chunk.bio.tell() + rows[part].nbytes + 64 * step > CHUNK_SIZE:
                self._end_chunk()
            storage.write_rows(connection.id, timestamps[part], rows[part])
            self.counts[connection.id] += len(timestamps[part])
        if len(timestamps):
            self.min_timestamp = min(int(timestamps[0]), self.min_timestamp)
            self.max_timestamp = max(int(timestamps[-1]), self.max_timestamp)

    def _end_chunk(self) -> None:
        storage: Any = self.storage
        if (len(storage.chunks) + 1) % self._chunks:
            storage.close_chunk()
        else:
            self.flush()

    def flush(self) -> None:
        """Write what has come, with everything that a whole bag has."""
        storage = self.storage
        super().close()
        self.storage = storage

    def close(self) -> None:
        """Write what has come and end."""
        storage: Any = self.storage
        super().close()
        storage.finish()
