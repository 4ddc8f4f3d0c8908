"""Bags as other programs write them: no library that we read with.

MCAP: by the package `mcap`, with the choices of rosbag2_storage_mcap. SQLite and metadata.yaml: as rosbag2 in
Humble, Jazzy and Rolling.
"""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from mcap.writer import CompressionType, IndexType, Writer
from rosbags.rosbag2.storage_mcap import zstd

START: Final = 1_600_000_000_000_000_000  # ns
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
    compression: CompressionType | None = CompressionType.ZSTD,
    summary: bool = True,
    statistics: bool = True,
    extras: bool = False,
) -> None:
    """Write an MCAP file with two messages in a chunk.

    Args:
        path: The file.
        messages: In the order in which they are written.
        distro: Whose QoS the channels have; none by default.
        compression: Of chunks; None: without chunks.
        summary: The file has one.
        statistics: The summary has them.
        extras: Records of attachments, of metadata and of an unknown kind.
    """
    with path.open('wb') as file:
        writer = Writer(
            file,
            chunk_size=100,
            compression=compression or CompressionType.NONE,
            use_chunking=compression is not None,
            index_types=IndexType.ALL if summary else IndexType.NONE,
            repeat_channels=summary,
            repeat_schemas=summary,
            use_statistics=summary and statistics,
            use_summary_offsets=summary,
        )
        writer.start('ros2', 'foreign')
        if extras:
            writer.add_attachment(START, START, 'cell.urdf', 'text/xml', b'<robot/>')
            writer.add_metadata('rosbag2', {'serialized_metadata': 'version: 9\n'})
            file.write(b'\x80' + struct.pack('<Q', 18) + b'of a later version')
        channels = {
            topic: _channel(writer, topic, distro) for topic in dict.fromkeys(one for _, one, _ in messages)
        }
        for number, (time, topic, data) in enumerate(messages):
            writer.add_message(channels[topic], START + time, data, START + time, number)
        writer.finish()


def _channel(writer: Writer, topic: Topic, distro: str) -> int:
    encoding = topic.encoding if topic.definition else ''
    schema = writer.register_schema(topic.type, encoding, topic.definition.encode())
    metadata = {'offered_qos_profiles': topic.qos(distro)} if distro else {}
    if distro == 'jazzy':
        metadata['topic_type_hash'] = HASH
    return writer.register_channel(topic.name, 'cdr', schema, metadata)


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
            write_mcap(file, part, distro=distro, compression=None if compression else CompressionType.ZSTD)
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
