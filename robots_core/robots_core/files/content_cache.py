"""What takes long to compute, kept in the user's cache folder by the content that it is computed from."""

import fcntl
import hashlib
import logging
import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

Arrays = Mapping[str, NDArray[Any]]

_LOG = logging.getLogger(__name__)


def cache_folder() -> Path:
    """The folder: `robots` in XDG_CACHE_HOME, which is `~/.cache` by default."""
    return Path(os.environ.get('XDG_CACHE_HOME') or Path('~/.cache').expanduser()) / 'robots'


def content_of(parts: Iterable[object]) -> str:
    """Digest of arrays, bytes, and what `repr` states exactly."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(repr((part.dtype.str, part.shape)).encode())
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(part if isinstance(part, bytes) else repr(part).encode())
    return digest.hexdigest()


def kept(kind: str, content: str, compute: Callable[[], Arrays], *, announce: str = '') -> Arrays:
    """Arrays that are computed once: several processes that need them at once wait for the first.

    Where the folder cannot be used, they are computed every time.

    Args:
        kind: What they are; part of the file's name.
        content: Digest of all that they depend on.
        compute: Computes them; without objects among their values.
        announce: Logged before they are computed, for what takes seconds.
    """
    folder = cache_folder()
    file = folder / f'{kind}-{content[:32]}.npz'
    found = _read(file)
    if found is not None:
        return found
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / f'{kind}.lock').open('a') as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            found = _read(file)
            if found is None:
                found = _computed(compute, announce)
                _write(file, found)
    except OSError as problem:
        _LOG.warning('%s is not kept in %s: %s', kind, folder, problem.strerror)
        return _computed(compute, announce) if found is None else found
    return found


def _computed(compute: Callable[[], Arrays], announce: str) -> Arrays:
    if announce:
        _LOG.warning('%s', announce)
    return compute()


def _read(file: Path) -> Arrays | None:
    try:
        with np.load(file, allow_pickle=False) as arrays:
            return dict(arrays)
    except (OSError, ValueError, EOFError, BadZipFile):  # none yet, or damaged
        return None


def _write(file: Path, arrays: Arrays) -> None:
    unfinished = file.with_suffix(f'.{os.getpid()}.npz')
    np.savez(unfinished, allow_pickle=False, **dict(arrays))
    unfinished.replace(file)
