"""Files that users give: regular ones, bounded in size, read whole or refused with the reason."""

import os
import stat
from pathlib import Path
from typing import Final

from robots_core.errors import UnreadableFileError

MAX_TEXT: Final = 20_000_000  # bytes
MAX_MESH: Final = 500_000_000  # bytes


def read_bytes(
    path: Path | str,
    what: str = 'file',
    *,
    largest: int = MAX_TEXT,
) -> bytes:
    """The bytes of a file.

    Args:
        path: The file.
        what: What it is, for errors.
        largest: Its largest size, bytes.

    Raises:
        UnreadableFileError: there is no such file, it is not a regular one, is too large, or cannot be read.
    """
    check_file(path, what, largest=largest)
    try:
        return Path(path).read_bytes()
    except OSError as problem:
        raise _unreadable(path, what, problem) from None


def when_written(path: Path | str) -> int:
    """When a file was written, ns since 1970; 0 where there is none of this name, or it cannot be one."""
    try:
        found = Path(path).stat()
    except (OSError, ValueError):  # ValueError: a null character in the path
        return 0
    return found.st_mtime_ns if stat.S_ISREG(found.st_mode) else 0


def check_file(path: Path | str, what: str, *, largest: float) -> None:
    """Refuse what cannot be read whole, before a library opens it.

    Args:
        path: The file.
        what: What it is, for errors.
        largest: Its largest size, bytes; infinite for files as large as they are.

    Raises:
        UnreadableFileError: as `read_bytes`.
    """
    try:
        found = Path(path).stat()
    except FileNotFoundError:
        raise UnreadableFileError(f'there is no {what} {path}') from None
    except (OSError, ValueError) as problem:  # ValueError: a null character in the path
        raise _unreadable(path, what, problem) from None
    if stat.S_ISDIR(found.st_mode):
        raise UnreadableFileError(f'{path} is a directory; a {what} is a file')
    if not stat.S_ISREG(found.st_mode):  # a device has no end, a pipe perhaps no beginning
        raise UnreadableFileError(f'the {what} {path} cannot be read: it is no regular file')
    if found.st_size > largest:
        size = found.st_size
        raise UnreadableFileError(f'the {what} {path} has {size} bytes; at most {largest} are read')


def read_text(path: Path | str, what: str = 'file', *, largest: int = MAX_TEXT) -> str:
    """The text of a UTF-8 file; see `read_bytes`.

    Raises:
        UnreadableFileError: as there, or a line is not UTF-8.
    """
    data = read_bytes(path, what, largest=largest)
    try:
        return data.decode('utf-8-sig')
    except UnicodeDecodeError as problem:
        line = data.count(b'\n', 0, problem.start) + 1
        raise UnreadableFileError(
            f'{Path(path).name}:{line}: byte 0x{data[problem.start]:02x} is not UTF-8; save the {what} as '
            'UTF-8 text',
            file=Path(path).name,
            line=line,
        ) from None


def exists(path: Path | str) -> bool:
    """Whether there is something at a path; not if the system refuses the path, as one that is too long."""
    return os.path.exists(path)  # noqa: PTH110  # Path.exists raises OSError there


def is_file(path: Path | str) -> bool:
    """Whether there is a file at a path; see `exists`."""
    return os.path.isfile(path)  # noqa: PTH113


def _unreadable(path: Path | str, what: str, problem: Exception) -> UnreadableFileError:
    reason = getattr(problem, 'strerror', None) or problem
    return UnreadableFileError(f'the {what} {path} cannot be read: {reason}')
