"""Bags as other programs write them, from the formats' specifications: no library that we read with.

MCAP: https://mcap.dev/spec, with the choices of the Python package `mcap` and of rosbag2_storage_mcap. SQLite
and metadata.yaml: rosbag2 in Humble, Jazzy and Rolling.
"""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from zlib import crc32

from lz4.frame import compress as lz4
from rosbags.rosbag2.storage_mcap import zstd

START: Final = 1_600_000_000_000_000_000  # ns
MAGIC: Final = b'\x89MCAP0\r\n'
COMPRESSORS: Final[Mapping[str, Callable[[bytes], bytes]]] = {'': bytes, 'lz4': lz4, 'zstd': zstd.compress}
HASH: Final = 'RIHS01_' + 64 * '0'
QOS: Final[Mapping[str, str]] = {
    'humble': """- history: 3
  depth: 0
  reliability: 1
  durability: {durability}
  deadline: {{sec: 9223372036, nsec: 854775807}}
  lifespan: {{sec: 9223372036, nsec: 854775807}}
  liveliness: 1
  liveliness_lease_duration: {{sec: 9223372036, nsec: 854775807}}
  avoid_ros_namespace_conventions: false""",
    'jazzy': """- history: unknown
  depth: 0
  reliability: reliable
  durability: {durability}
  deadline: {{sec: 9223372036, nsec: 854775807}}
  lifespan: {{sec: 9223372036, nsec: 854775807}}
  liveliness: automatic
  liveliness_lease_duration: {{sec: 9223372036, nsec: 854775807}}
  avoid_ros_namespace_conventions: false""",
}
DURABILITY: Final = {'humble': (2, 1), 'jazzy': ('volatile', 'transient_local')}


@dataclass(frozen=True)
class Topic:
    """A topic and its type; `definition` '' where the writer has none."""

    name: str
    type: str
    definition: str = ''
    encoding: str = 'ros2msg'
    latched: bool = False

    def qos(self, distro: str) -> str:
        """As a distribution writes it."""
        return QOS[distro].format(durability=DURABILITY[distro][self.latched])


Message = tuple[int, Topic, bytes]
"""Time of logging (ns since `START`), topic, data."""


def double(value: float) -> bytes:
    """A message with one float64, in CDR."""
    return b'\x00\x01\x00\x00' + struct.pack('<d', value)


def text(value: str) -> bytes:
    """A message with one string, in CDR."""
    data = value.encode() + b'\0'
    return b'\x00\x01\x00\x00' + struct.pack('<I', len(data)) + data


def write_mcap(
    path: Path,
    messages: Sequence[Message],
    *,
    distro: str = '',
    compression: str | None = 'zstd',
    summary: bool = True,
    statistics: bool = True,
    extras: bool = False,
) -> None:
    """Write an MCAP file with two messages in a chunk.

    Args:
        path: The file.
        messages: In the order in which they are written.
        distro: Whose QoS the channels have; none by default, as those of the package `mcap`.
        compression: Of chunks; None: without chunks.
        summary: The file has one.
        statistics: The summary has them.
        extras: Records of attachments, of metadata and of an unknown kind.
    """
    topics = list(dict.fromkeys(topic for _, topic, _ in messages))
    defined = b''.join(_definition(n, topic, distro) for n, topic in enumerate(topics, 1))
    out = bytearray(MAGIC + _record(1, _string('ros2') + _string('foreign')))
    if extras:
        attached = struct.pack('<QQ', START, START) + _string('cell.urdf') + _string('text/xml')
        attached += struct.pack('<Q', 8) + b'<robot/>'
        out += _record(9, attached + struct.pack('<I', crc32(attached)))
        out += _record(12, _string('rosbag2') + _map({'serialized_metadata': 'version: 9\n'}))
        out += _record(0x80, b'of a later version')
    chunks = bytearray()
    size = len(messages) if compression is None else 2
    for first in range(0, len(messages), size):
        part = messages[first : first + size]
        body = bytearray(b'' if first else defined)
        places: dict[int, list[tuple[int, int]]] = {}
        for number, (time, topic, data) in enumerate(part, first):
            channel, stamp = topics.index(topic) + 1, START + time
            places.setdefault(channel, []).append((stamp, len(body)))
            body += _record(5, struct.pack('<HIQQ', channel, number, stamp, stamp) + data)
        if compression is None:
            out += body
        else:
            times = [START + time for time, _, _ in part]
            span = struct.pack('<QQ', min(times), max(times))
            chunks += _chunk(out, bytes(body), places, span, compression)
    out += _record(15, struct.pack('<I', 0))
    start = len(out) if summary else 0
    if summary:
        out += defined
        if statistics:
            counts = [sum(topic == one for _, topic, _ in messages) for one in topics]
            times = [START + time for time, _, _ in messages]
            numbers = len(messages), len(topics), len(topics), 0, 0, 0, min(times), max(times)
            counted = b''.join(struct.pack('<HQ', n, count) for n, count in enumerate(counts, 1))
            out += _record(11, struct.pack('<QHIIIIQQ', *numbers) + _sized(counted))
        out += chunks
    out += _record(2, struct.pack('<QQI', start, 0, 0)) + MAGIC
    path.write_bytes(out)


def _chunk(
    out: bytearray, body: bytes, places: Mapping[int, list[tuple[int, int]]], span: bytes, compression: str
) -> bytes:
    """Append a chunk with its message index; returns the record of the chunk index."""
    begin, packed = len(out), COMPRESSORS[compression](body)
    head = span + struct.pack('<QI', len(body), crc32(body)) + _string(compression)
    out += _record(6, head + struct.pack('<Q', len(packed)) + packed)
    end, offsets = len(out), b''
    for channel, found in places.items():
        offsets += struct.pack('<HQ', channel, len(out))
        entries = b''.join(struct.pack('<QQ', *one) for one in found)
        out += _record(7, struct.pack('<H', channel) + _sized(entries))
    index = span + struct.pack('<QQ', begin, end - begin) + _sized(offsets)
    index += struct.pack('<Q', len(out) - end) + _string(compression)
    return _record(8, index + struct.pack('<QQ', len(packed), len(body)))


def _definition(number: int, topic: Topic, distro: str) -> bytes:
    encoding = topic.encoding if topic.definition else ''
    schema = struct.pack('<H', number) + _string(topic.type) + _string(encoding)
    metadata = {'offered_qos_profiles': topic.qos(distro)} if distro else {}
    if distro == 'jazzy':
        metadata['topic_type_hash'] = HASH
    channel = struct.pack('<HH', number, number) + _string(topic.name) + _string('cdr') + _map(metadata)
    return _record(3, schema + _string(topic.definition)) + _record(4, channel)


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack('<BQ', kind, len(content)) + content


def _sized(data: bytes) -> bytes:
    return struct.pack('<I', len(data)) + data


def _string(value: str) -> bytes:
    return _sized(value.encode())


def _map(values: Mapping[str, str]) -> bytes:
    return _sized(b''.join(_string(key) + _string(value) for key, value in values.items()))


def write_database(path: Path, messages: Sequence[Message], *, distro: str) -> None:
    """Write a SQLite file: that of Humble has no definitions of messages."""
    topics = list(dict.fromkeys(topic for _, topic, _ in messages))
    jazzy = distro == 'jazzy'
    with sqlite3.connect(path) as database:
        database.executescript(
            'CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);'
            'CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL,'
            ' metadata TEXT NOT NULL);'
            'CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,'
            ' serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL'
            f'{", type_description_hash TEXT NOT NULL" if jazzy else ""});'
            'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,'
            ' timestamp INTEGER NOT NULL, data BLOB NOT NULL);'
            'CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL,'
            ' encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL,'
            ' type_description_hash TEXT NOT NULL);'
        )
        database.execute('INSERT INTO schema VALUES (?, ?)', (4, 'jazzy') if jazzy else (3, 'humble'))
        for number, topic in enumerate(topics, 1):
            row = [number, topic.name, topic.type, 'cdr', topic.qos(distro), HASH][: 6 if jazzy else 5]
            database.execute(f'INSERT INTO topics VALUES ({", ".join("?" * len(row))})', row)  # noqa: S608
            if jazzy and topic.definition:
                database.execute(
                    'INSERT INTO message_definitions VALUES (?, ?, ?, ?, ?)',
                    (number, topic.type, topic.encoding, topic.definition, HASH),
                )
        for time, topic, data in messages:
            row = [topics.index(topic) + 1, START + time, data]
            database.execute('INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)', row)
    database.close()


def write_foreign_bag(
    folder: Path, parts: Sequence[Sequence[Message]], *, distro: str, storage: str, compression: str = ''
) -> Path:
    """Write a bag of several files, with its metadata.

    Args:
        folder: Its folder; must not exist.
        parts: Messages of each file.
        distro: 'humble' or 'jazzy', whose format Rolling has too.
        storage: 'sqlite3' or 'mcap'.
        compression: 'FILE' or 'MESSAGE', by zstd; '' for none.
    """
    folder.mkdir()
    names = []
    for number, part in enumerate(parts):
        suffix = {'sqlite3': 'db3', 'mcap': 'mcap'}[storage]
        file = folder / f'{folder.name}_{number}.{suffix}'
        if compression == 'MESSAGE':
            part = [(time, topic, zstd.compress(data)) for time, topic, data in part]  # noqa: PLW2901
        if storage == 'mcap':
            write_mcap(file, part, distro=distro, compression=None if compression else 'zstd')
        else:
            write_database(file, part, distro=distro)
        if compression == 'FILE':
            file.with_name(f'{file.name}.zstd').write_bytes(zstd.compress(file.read_bytes()))
            file.unlink()
            file = file.with_name(f'{file.name}.zstd')
        names.append(file.name)
    (folder / 'metadata.yaml').write_text(_metadata(parts, names, distro, storage, compression))
    return folder


def _metadata(
    parts: Sequence[Sequence[Message]], names: Sequence[str], distro: str, storage: str, compression: str
) -> str:
    messages = [message for part in parts for message in part]
    lines = [
        'rosbag2_bagfile_information:',
        f'  version: {9 if distro == "jazzy" else 5}',
        f'  storage_identifier: {storage}',
        *_span(messages, '  '),
        f'  message_count: {len(messages)}',
        '  topics_with_message_count:',
    ]
    for topic in dict.fromkeys(topic for _, topic, _ in messages):
        lines += [
            '    - topic_metadata:',
            f'        name: {topic.name}',
            f'        type: {topic.type}',
            '        serialization_format: cdr',
            # Humble has a text, Jazzy a list.
            f'        offered_qos_profiles:{" |-" if distro == "humble" else ""}',
            *(f'          {line}' for line in topic.qos(distro).splitlines()),
        ]
        if distro == 'jazzy':
            lines.append(f'        type_description_hash: {HASH}')
        lines.append(f'      message_count: {sum(one is topic for _, one, _ in messages)}')
    lines += [
        f'  compression_format: {"zstd" if compression else chr(34) * 2}',
        f'  compression_mode: {compression or chr(34) * 2}',
        '  relative_file_paths:',
        *(f'    - {name}' for name in names),
        '  files:',
    ]
    for name, part in zip(names, parts, strict=True):
        lines += [f'    - path: {name}', *_span(part, '      '), f'      message_count: {len(part)}']
    if distro == 'jazzy':
        lines += ['  custom_data: ~', '  ros_distro: rolling']
    return '\n'.join(lines) + '\n'


def _span(messages: Sequence[Message], indent: str) -> list[str]:
    first, last = messages[0][0], messages[-1][0]
    return [
        f'{indent}duration:',
        f'{indent}  nanoseconds: {last - first}',
        f'{indent}starting_time:',
        f'{indent}  nanoseconds_since_epoch: {START + first}',
    ]
