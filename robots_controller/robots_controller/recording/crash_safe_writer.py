"""CrashSafeWriter: an MCAP bag that is whole at any time, so that a kill loses its last second alone."""

import json
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection, ConnectionExtRosbag2
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.enums import CompressionMode
from rosbags.rosbag2.metadata import dump_qos_v9
from rosbags.rosbag2.storage_mcap import McapWriter, PendingChunk, write_channel, write_schema

from robots_core.errors import BagError

VERSION: Final = 9  # of rosbag2's format
CHUNK_SIZE: Final = 1_000_000  # bytes; below the 2**20 at which the base class writes a chunk
# Chunks that may be given up so that the end of the file fits, which has fitted behind the last one.
MOST_BACK: Final = 16
# Chunks of a file, whose index stays in memory and is written again by each flush: ten minutes of a flush a
# second.
MOST_CHUNKS: Final = 600
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
class _Extent:
    """How much of a file is written: its length, the chunks in it, and their messages by channel."""

    length: int
    chunks: int
    counts: dict[int, int]
    start: int
    end: int


@dataclass(frozen=True)
class _FileStem:
    """Stands for a bag's folder whose file the base class names after it."""

    folder: Path
    name: str

    def __truediv__(self, file: str) -> Path:
        return self.folder / file


class _LastingMcap(McapWriter):
    """Writes the file's end after every flush, and goes on over it.

    Args:
        path: Folder of the bag.
        compression: Of the bag.
        number: Of the file in the bag.
    """

    def __init__(self, path: Path, compression: CompressionMode, number: int = 0) -> None:
        stem: Any = _FileStem(path, f'{path.name}_{number}' if number else path.name)
        super().__init__(stem, compression)
        # Unbuffered: a buffer would try again later to write what has failed.
        self.bio = self.bio.detach()  # type: ignore[assignment]
        self._extents = deque([self._extent()], maxlen=MOST_BACK)

    def close_chunk(self) -> None:
        """Write the messages received so far."""
        self._write_at_once(super().close_chunk)
        self._extents.append(self._extent())

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
            self._extents.append(self._extent())

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

    def _extent(self) -> _Extent:
        counts = dict(self.channel_stats)
        return _Extent(
            self.bio.tell(), len(self.chunks), counts, self.message_start_time, self.message_end_time
        )

    def go_back(self) -> bool:
        """Forget what could not be written, or one chunk more with each call; False if there is none."""
        if not self._extents:
            return False
        extent = self._extents.pop()
        self.bio.seek(extent.length)
        self.bio.truncate()
        del self.chunks[extent.chunks :]
        self.chunk = PendingChunk(2**63 - 1, 0, BytesIO(), defaultdict(list))
        for channel in self.channel_stats:
            self.channel_stats[channel] = extent.counts.get(channel, 0)
        self.message_start_time, self.message_end_time = extent.start, extent.end
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
            **_span(self.message_start_time, self.message_end_time, sum(self.channel_stats.values())),
        }

    def successor(self, number: int) -> '_LastingMcap':
        """A further file of the bag with the same topics."""
        file = _LastingMcap(self.path.parent, CompressionMode.NONE, number)
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


def _span(start: int, end: int, count: int) -> dict[str, Any]:
    """When messages were sent, ns, and how many, in `metadata.yaml`."""
    return {
        'starting_time': {'nanoseconds_since_epoch': start},
        'duration': {'nanoseconds': max(0, end - start)},
        'message_count': count,
    }


class CrashSafeWriter(Writer):
    """A rosbag2 writer (MCAP) with a bag that any reader can open after each `flush`, whatever happens then.

    The bag continues in another file after `MOST_CHUNKS` chunks, so that neither the memory nor the time of a
    flush grows with the length of the recording.

    Where no more can be written, as on a full disk, it ends the bag with what is there and raises a
    RobotsError once; what comes after that is ignored.

    Args:
        path: Folder of the bag; must not exist.
        chunks: It flushes by itself after so many chunks of about a megabyte.
    """

    STORAGE_PLUGINS: Mapping[Any, Any] = MappingProxyType({StoragePlugin.MCAP: _LastingMcap})

    def __init__(self, path: Path, *, chunks: int = 1) -> None:
        super().__init__(path, version=VERSION, storage_plugin=StoragePlugin.MCAP)
        self._chunks = chunks
        self._finished: list[_LastingMcap] = []  # files before the one that is written
        self.ended = False
        """The bag is closed."""

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Take a message; it stays in memory until there are many, or until `flush`."""
        if self.ended:
            return
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
        # Whole rows at a time, so that a chunk never comes near the size at which the base class writes it.
        step = max(1, CHUNK_SIZE // (4 * (rows.shape[1] + 64)))
        for start in range(0, 0 if self.ended else len(timestamps), step):
            part = slice(start, start + step)
            storage: Any = self.storage
            if storage.chunk.bio.tell() + rows[part].nbytes + 64 * step > CHUNK_SIZE:
                self._end_chunk()
                storage = self.storage
            storage.write_rows(connection.id, timestamps[part], rows[part])
            self.counts[connection.id] += len(timestamps[part])
        if len(timestamps):
            self.min_timestamp = min(int(timestamps[0]), self.min_timestamp)
            self.max_timestamp = max(int(timestamps[-1]), self.max_timestamp)

    def _end_chunk(self) -> None:
        storage: Any = self.storage
        if (len(storage.chunks) + 1) % self._chunks:
            with self._ended_by_errors():
                storage.close_chunk()
        else:
            self.flush()

    def flush(self) -> None:
        """Write what has come, with everything that a whole bag has.

        Raises:
            RobotsError: it cannot be written; as of `write`, `write_rows` and `close`.
        """
        if not self.ended:
            with self._ended_by_errors():
                self._save()
                storage: Any = self.storage
                if len(storage.chunks) >= MOST_CHUNKS:
                    self._begin_file(storage)

    def _begin_file(self, last: _LastingMcap) -> None:
        """Go on in another file; the bag has it from the next flush on."""
        file = last.successor(len(self._finished) + 1)
        last.finish()
        self._finished.append(last)
        self.storage = file

    @property
    def _files(self) -> list[_LastingMcap]:
        storage: Any = self.storage
        return [*self._finished, storage]

    def close(self) -> None:
        """Write what has come and end."""
        if not self.ended:
            storage: Any = self.storage
            self.flush()
            self.ended = True
            storage.finish()

    def _save(self) -> None:
        description = self._description()
        storage: Any = self.storage
        storage.close(VERSION, json.dumps(description))
        # A reader finds the old description or the new one.
        new = self.metapath.with_suffix('.yaml.tmp')
        new.write_text(json.dumps({'rosbag2_bagfile_information': description}, indent=2), 'utf8')
        new.replace(self.metapath)

    def _description(self) -> dict[str, Any]:
        """What `metadata.yaml` has: JSON is YAML, and written in no time every second."""
        files = [file.description for file in self._files]
        span = _span(self.min_timestamp, self.max_timestamp, sum(self.counts.values()))
        topics = []
        for connection in self.connections:
            assert isinstance(connection.ext, ConnectionExtRosbag2)
            ext = connection.ext
            metadata = {
                'name': connection.topic,
                'type': connection.msgtype,
                'serialization_format': ext.serialization_format,
                'offered_qos_profiles': dump_qos_v9(ext.offered_qos_profiles),
                'type_description_hash': connection.digest,
            }
            topics.append({'topic_metadata': metadata, 'message_count': self.counts[connection.id]})
        return {
            'version': VERSION,
            'storage_identifier': 'mcap',
            'relative_file_paths': [file['path'] for file in files],
            **span,
            'topics_with_message_count': topics,
            'compression_format': '',
            'compression_mode': '',
            'files': files,
            'custom_data': None,
            'ros_distro': 'rosbags',
        }

    @contextmanager
    def _ended_by_errors(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.ended = True
            self._save_what_fits()
            raise BagError(f'{self.path} cannot take more: {error.strerror}; it ends early') from error

    def _save_what_fits(self) -> None:
        storage: Any = self.storage
        saved = False
        while not saved and storage.go_back():
            files = self._files
            self.counts = {key: sum(file.channel_stats.get(key, 0) for file in files) for key in self.counts}
            self.min_timestamp = min(file.message_start_time for file in files)
            self.max_timestamp = max(file.message_end_time for file in files)
            with suppress(OSError):
                self._save()
                saved = True
        storage.finish()
