"""What is left in an MCAP file that was cut off: every whole record up to the cut.

Record layout: MCAP specification, https://mcap.dev/spec.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.storage_mcap import decompress, get_qos

from robots_controller.recording.bag_topic import BagTopic, latched
from robots_core.errors import RobotsError

MAGIC: Final = b'\x89MCAP0\r\n'
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x0F


@dataclass
class Recovered:
    """Whole records of a file.

    Attributes:
        topics: By their channel's number in the file.
        messages: (channel, time of logging in ns, data), in the file's order.
        complete: The file has its end.
        size: How many bytes were whole records.
    """

    topics: dict[int, BagTopic] = field(default_factory=dict)
    messages: list[tuple[int, int, bytes]] = field(default_factory=list)
    complete: bool = False
    size: int = 0


def recover_mcap(path: Path) -> Recovered:
    """Read an MCAP file up to where it is damaged.

    Raises:
        RobotsError: it is no MCAP file of ROS 2 at all.
    """
    data = path.read_bytes()
    if not data:
        raise RobotsError(f'{path} is empty')
    if not data.startswith(MAGIC):
        raise RobotsError(f'{path} is no MCAP file: it begins with {data[:8]!r}')
    found = Recovered(size=len(MAGIC))
    schemas: dict[int, tuple[str, str, str]] = {}
    try:
        for operation, record, end in _records(data, len(MAGIC)):
            if operation == _CHUNK:
                for inner, content, _ in _records(_uncompressed(record), 0):
                    _take(inner, content, found, schemas)
            elif operation in (_DATA_END, _FOOTER):
                found.complete = True
                break
            else:
                _take(operation, record, found, schemas)
            found.size = end
    except (ReaderError, struct.error, UnicodeDecodeError, ValueError, EOFError, RuntimeError):
        pass  # the damage: what was whole before it stays
    return found


def _records(data: bytes, start: int) -> Iterator[tuple[int, bytes, int]]:
    while start + 9 <= len(data):
        operation, size = struct.unpack_from('<BQ', data, start)
        end = start + 9 + size
        if end > len(data) or operation == 0:
            return
        yield operation, data[start + 9 : end], end
        start = end


def _uncompressed(record: bytes) -> bytes:
    size, checksum = struct.unpack_from('<QI', record, 16)
    compression, position = _text(record, 28)
    (length,) = struct.unpack_from('<Q', record, position)
    return decompress(record[position + 8 : position + 8 + length], compression, size, checksum)


def _take(operation: int, record: bytes, found: Recovered, schemas: dict[int, tuple[str, str, str]]) -> None:
    if operation == _HEADER:
        profile, _ = _text(record, 0)
        if profile != 'ros2':
            raise RobotsError(f'the MCAP file is of profile {profile!r}; needed is ros2')
    elif operation == _SCHEMA:
        name, position = _text(record, 2)
        encoding, position = _text(record, position)
        text, _ = _text(record, position)
        schemas[struct.unpack_from('<H', record)[0]] = name, encoding, text
    elif operation == _CHANNEL:
        number, schema = struct.unpack_from('<HH', record)
        topic, position = _text(record, 4)
        encoding, position = _text(record, position)
        metadata_size = struct.unpack_from('<I', record, position)[0]
        if encoding != 'cdr':
            raise RobotsError(f'{topic} has messages in {encoding!r}; read is cdr')
        profiles = get_qos(record[position + 4 : position + 4 + metadata_size])
        name, definition_encoding, text = schemas.get(schema, ('', '', ''))
        kind = 'idl' if definition_encoding.endswith('idl') else 'msg'
        found.topics[number] = BagTopic(topic, name, latched(profiles), text, kind)
    elif operation == _MESSAGE:
        number, _, stamp, _ = struct.unpack_from('<HIQQ', record)
        if number in found.topics:
            found.messages.append((number, stamp, record[22:]))


def _text(data: bytes, position: int) -> tuple[str, int]:
    (size,) = struct.unpack_from('<I', data, position)
    end = position + 4 + size
    if end > len(data):
        raise EOFError
    return data[position + 4 : end].decode(), end
