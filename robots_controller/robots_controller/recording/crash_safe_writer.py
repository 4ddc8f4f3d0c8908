"""CrashSafeWriter: a bag that is whole at any time, so that a kill loses its last second alone."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection, ConnectionExtRosbag2
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.metadata import dump_qos_v9

from robots_controller.recording.crash_safe_file import CrashSafeFile, time_span
from robots_core.errors import BagError

VERSION: Final = 9  # of rosbag2's format
CHUNK_SIZE: Final = 1_000_000  # bytes; below the 2**20 at which the base class writes a chunk
# Chunks of a file, whose index stays in memory and is written again by each flush: ten minutes of a flush a
# second.
MOST_CHUNKS: Final = 600


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

    STORAGE_PLUGINS: Mapping[Any, Any] = MappingProxyType({StoragePlugin.MCAP: CrashSafeFile})

    def __init__(self, path: Path, *, chunks: int = 1) -> None:
        super().__init__(path, version=VERSION, storage_plugin=StoragePlugin.MCAP)
        self._chunks = chunks
        self._finished: list[CrashSafeFile] = []  # files before the one that is written
        self.ended = False
        """The bag is closed."""

    @property
    def _file(self) -> CrashSafeFile:
        """The file that is written."""
        assert isinstance(self.storage, CrashSafeFile)
        return self.storage

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Take a message; it stays in memory until there are many, or until `flush`."""
        if self.ended:
            return
        if self._file.chunk.bio.tell() + len(data) > CHUNK_SIZE:
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
            if self._file.chunk.bio.tell() + rows[part].nbytes + 64 * step > CHUNK_SIZE:
                self._end_chunk()
            self._file.write_rows(connection.id, timestamps[part], rows[part])

    def _end_chunk(self) -> None:
        if (len(self._file.chunks) + 1) % self._chunks:
            with self._ended_by_errors():
                self._file.close_chunk()
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
                last = self._file
                if len(last.chunks) >= MOST_CHUNKS:  # the bag has its next file from the next flush on
                    self.storage = last.successor(len(self._finished) + 1)
                    last.finish()
                    self._finished.append(last)

    def close(self) -> None:
        """Write what has come and end."""
        if not self.ended:
            self.flush()
            self.ended = True
            self._file.finish()

    def _save(self) -> None:
        description = self._description()
        self._file.close(VERSION, json.dumps(description))
        # A reader finds the old description or the new one.
        new = self.metapath.with_suffix('.yaml.tmp')
        text = json.dumps({'rosbag2_bagfile_information': description}, separators=(',\n ', ': '))
        new.write_text(text, 'utf8')
        new.replace(self.metapath)

    def _description(self) -> dict[str, Any]:
        """What `metadata.yaml` has: JSON is YAML, and written in no time every second."""
        written = [*self._finished, self._file]
        files = [file.description for file in written]
        counts = sum((Counter(file.channel_stats) for file in written), Counter[int]())
        start = min(file.message_start_time for file in written)
        end = max(file.message_end_time for file in written)
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
            topics.append({'topic_metadata': metadata, 'message_count': counts[connection.id]})
        return {
            'version': VERSION,
            'storage_identifier': 'mcap',
            'relative_file_paths': [file['path'] for file in files],
            **time_span(start, end, counts.total()),
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
        saved = False
        while not saved and self._file.go_back():
            with suppress(OSError):
                self._save()
                saved = True
        self._file.finish()
