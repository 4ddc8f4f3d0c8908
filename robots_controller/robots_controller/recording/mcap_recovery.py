"""What is left in an MCAP file that was cut off: every whole record up to the cut.

Record layout: MCAP specification, https://mcap.dev/spec.
"""

import os
import struct
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, Final

from rosbags.interfaces import Connection
from rosbags.rosbag2.storage_mcap import McapReader

from robots_core.errors import BagError

MAGIC: Final = b'\x89MCAP0\r\n'
PROFILE: Final = slice(21, 25)  # in the header, behind its opcode and two lengths
_FOOTER, _DATA_END = 0x02, 0x0F
Message = tuple[Connection, int, bytes]
"""Channel, time of logging in ns, data."""


def recover_mcap(path: Path) -> tuple[list[Connection], list[Message], str]:
    """Read an MCAP file up to where it is damaged.

    Returns:
        Its channels, its whole messages in their order, and what is wrong with it, '' for nothing.

    Raises:
        RobotsError: it is no MCAP file of ROS 2 at all.
    """
    try:
        with path.open('rb') as file:
            return _recovered(path, file)
    except OSError as error:
        raise BagError(f'{path} cannot be read: {error.strerror}') from error


def _recovered(path: Path, file: BinaryIO) -> tuple[list[Connection], list[Message], str]:
    start = file.read(PROFILE.stop)
    if not start:
        raise BagError(f'{path} is empty')
    if not start.startswith(MAGIC):
        raise BagError(f'{path} is no MCAP file: it begins with {start[:8]!r}')
    size, ended = _whole_records(file)
    if size > len(MAGIC) and start[PROFILE] != b'ros2':
        raise BagError(f'the MCAP file is of profile {start[PROFILE]!r} ...; needed is ros2')
    reader = McapReader(path)
    reader.bio, reader.data_start, reader.data_end = file, len(MAGIC), size
    messages: list[Message] = []
    # Damaged records fail in as many ways as they have bytes: what was whole before them stays.
    with suppress(Exception):
        reader.meta_scan()
    with suppress(Exception):
        for message in reader.messages_scan(reader.connections):
            messages.append(message)  # noqa: PERF402  # those before an error stay
    whole = ended and reader.statistics is not None
    problem = '' if whole else f'{path.name} is damaged or cut off after {size} bytes'
    return reader.connections, messages, problem


def _whole_records(file: BinaryIO) -> tuple[int, bool]:
    """Where the whole records of a file end, and whether its data do there."""
    position, length = len(MAGIC), file.seek(0, os.SEEK_END)
    while position + 9 <= length:
        file.seek(position)
        operation, size = struct.unpack('<BQ', file.read(9))
        if operation in (_DATA_END, _FOOTER):
            return position, True
        if operation == 0 or position + 9 + size > length:
            break
        position += 9 + size
    return position, False
