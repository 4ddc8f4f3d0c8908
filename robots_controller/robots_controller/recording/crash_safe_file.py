"""CrashSafeFile: one MCAP file of a bag, whole at any time, so that a kill loses its last second alone."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2.enums import CompressionMode
from rosbags.rosbag2.storage_mcap import McapWriter, PendingChunk, write_channel, write_schema

# Chunks that may be given up so that the end of the file fits, which has fitted behind the last one.
MOST_BACK: Final = 16
MESSAGE_OPCODE: Final = 0x05
# Of MCAP's record of a message, which begins with its opcode and its length.
MESSAGE_HEAD: Final = (('opcode', 'u1'), ('length', '<u8'))
MESSAGE_FIELDS: Final = (
    ('channel', '<u2'),
    ('sequence', '<u4'),
    ('log_time', '<u8'),
    ('publish_time', '<u8'),
)


@dataclass(frozen=True)
class _FileStem:
    """Stands for a bag's folder whose file the base class names after it."""

    folder: Path
    name: str

    def __truediv__(self, file: str) -> Path:
        return self.folder / file


class CrashSafeFile(McapWriter):
    """Writes the file's end after every flush, and goes on over it; `path` is the folder of the bag."""

    def __init__(self, path: Path, compression: CompressionMode, number: int = 0) -> None:
        stem: Any = _FileStem(path, f'{path.name}_{number}' if number else path.name)
        super().__init__(stem, compression)
        # Unbuffered: a buffer would try again later to write what has failed.
        self.bio = self.bio.detach()  # type: ignore[assignment]
        self._extents: deque[tuple[int, int, dict[int, int], int, int]] = deque(maxlen=MOST_BACK)
        self._keep_extent()

    def close_chunk(self) -> None:
        """Write the messages received so far."""
        self._write_at_once(super().close_chunk)
        self._keep_extent()

    def close(self, version: int, metadata: str) -> None:
        """Write the messages received so far and the end of the file; more may follow."""
        length = 0
        more = self.chunk.bio.tell() > 0

        def write() -> None:
            nonlocal length
            if more:
                McapWriter.close_chunk(self)
            length = self.bio.tell()
            McapWriter.close(self, version, metadata)

        self._write_at_once(write)
        self.bio.seek(length)
        if more:  # otherwise `go_back` would come to the same extent again and again
            self._keep_extent()

    def _write_at_once(self, write: Callable[[], None]) -> None:
        """In one piece: a kill hits between two writes, hardly ever inside one."""
        file, tail = self.bio, _Tail(self.bio.tell())
        self.bio = tail  # type: ignore[assignment]  # all that the base class does is write and tell
        try:
            write()
        finally:
            self.bio = file
        rest = memoryview(tail.getvalue())
        while rest:
            rest = rest[file.write(rest) :]

    def _keep_extent(self) -> None:
        """Keep how much is written: length, chunks, messages by channel, and their first and last time."""
        length, counts = self.bio.tell(), self.channel_stats.copy()
        span = self.message_start_time, self.message_end_time
        self._extents.append((length, len(self.chunks), counts, *span))

    def go_back(self) -> bool:
        """Forget what could not be written, or one chunk more with each call; False if there is none."""
        if not self._extents:
            return False
        length, chunks, counts, self.message_start_time, self.message_end_time = self._extents.pop()
        self.bio.seek(length)
        self.bio.truncate()
        del self.chunks[chunks:]
        self.chunk = PendingChunk(2**63 - 1, 0, BytesIO(), defaultdict(list))
        self.channel_stats = dict.fromkeys(self.channel_stats, 0) | counts
        return True

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
        """Close the file, and keep what describes it."""
        self.bio.close()
        self.chunks.clear()
        self._extents.clear()

    @property
    def description(self) -> dict[str, Any]:
        """The file in `metadata.yaml`."""
        return {
            'path': self.path.name,
            **time_span(self.message_start_time, self.message_end_time, sum(self.channel_stats.values())),
        }

    def successor(self, number: int) -> CrashSafeFile:
        """A further file of the bag with the same topics."""
        file = CrashSafeFile(self.path.parent, CompressionMode.NONE, number)
        file.schemas, file.channels = self.schemas.copy(), self.channels.copy()
        file.channel_stats = dict.fromkeys(self.channel_stats, 0)
        # Readers that scan the file, because its end is damaged, need them before the messages.
        for schema in file.schemas:
            write_schema(file.chunk.bio, schema)
        for channel in file.channels:
            write_channel(file.chunk.bio, channel, file.schemas)
        return file


class _Tail(BytesIO):
    """What will stand in the file from an offset on; positions are those in the file."""

    def __init__(self, offset: int) -> None:
        super().__init__()
        self._offset = offset

    def tell(self) -> int:
        return self._offset + super().tell()

    def close(self) -> None:
        """Stay: the content is still needed."""


def time_span(start: int, end: int, count: int) -> dict[str, Any]:
    """When messages were sent, ns, and how many, in `metadata.yaml`."""
    return {
        'starting_time': {'nanoseconds_since_epoch': start},
        'duration': {'nanoseconds': max(0, end - start)},
        'message_count': count,
    }
