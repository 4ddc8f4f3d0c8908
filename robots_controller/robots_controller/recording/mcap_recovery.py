"""What is left in an MCAP file that was cut off: every whole record up to the cut.

Record layout: MCAP specification, https://mcap.dev/spec.
"""

import struct
from contextlib import suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Final

from rosbags.interfaces import Connection
from rosbags.rosbag2.storage_mcap import McapReader

from robots_core.errors import BagError

MAGIC: Final = b'\x89MCAP0\r\n'
PROFILE: Final = slice(21, 25)  # in the header, behind its opcode and two lengths
_FOOTER, _DATA_END = 0x02, 0x0F


@dataclass(frozen=True)
class Recovered:
    """Whole records of a file.

    Attributes:
        connections: Of all channels.
        messages: (connection, time of logging in ns, data), in the file's order.
        complete: The file has all its messages.
        size: How many bytes were whole records.
    """

    connections: list[Connection]
    messages: list[tuple[Connection, int, bytes]]
    complete: bool
    size: int


def recover_mcap(path: Path) -> Recovered:
    """Read an MCAP file up to where it is damaged.

    Raises:
        RobotsError: it is no MCAP file of ROS 2 at all.
    """
    data = path.read_bytes()
    if not data:
        raise BagError(f'{path} is empty')
    if not data.startswith(MAGIC):
        raise BagError(f'{path} is no MCAP file: it begins with {data[:8]!r}')
    size, ended = _whole_records(data)
    if size > len(MAGIC) and data[PROFILE] != b'ros2':
        raise BagError(f'the MCAP file is of profile {data[PROFILE]!r} ...; needed is ros2')
    reader = McapReader(path)
    reader.bio, reader.data_start, reader.data_end = BytesIO(data[:size]), len(MAGIC), size
    messages: list[tuple[Connection, int, bytes]] = []
    # Damaged records fail in as many ways as they have bytes: what was whole before them stays.
    with suppress(Exception):
        reader.meta_scan()
    with suppress(Exception):
        for message in reader.messages_scan(reader.connections):
            messages.append(message)  # noqa: PERF402  # those before an error stay
    return Recovered(reader.connections, messages, ended and reader.statistics is not None, size)


def _whole_records(data: bytes) -> tuple[int, bool]:
    """Where the whole records of a file end, and whether its data do there."""
    position = len(MAGIC)
    while position + 9 <= len(data):
        operation, size = struct.unpack_from('<BQ', data, position)
        if operation in (_DATA_END, _FOOTER):
            return position, True
        if operation == 0 or position + 9 + size > len(data):
            break
        position += 9 + size
    return position, False
