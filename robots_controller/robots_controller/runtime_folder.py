"""Files that last until this machine restarts: which cells run, and what has started once."""

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from robots_core.errors import InstallationError


def first_time(name: str) -> bool:
    """True for the first call with a name, of all processes of this user.

    Raises:
        RobotsError: the folder for that cannot be used.
    """
    try:
        (_folder() / f'{quote(name, safe="")}.started').open('x').close()
    except FileExistsError:
        return False
    return True


@contextmanager
def alone(name: str) -> Iterator[None]:
    """Be the only process of this user with a name; the system ends that with the process.

    Raises:
        RobotsError: another one is; or the folder for that cannot be used.
    """
    with (_folder() / f'{quote(name, safe="")}.lock').open('a+') as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            raise InstallationError(f'it is process {file.read() or "?"}') from None
        file.truncate(0)
        file.write(str(os.getpid()))
        file.flush()
        yield


def _folder() -> Path:
    session = os.environ.get('XDG_RUNTIME_DIR', '')
    folder = Path(session, 'robots') if session else Path(tempfile.gettempdir(), f'robots-{os.getuid()}')
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        owner = folder.stat().st_uid
    except OSError as error:
        raise InstallationError(f'{folder} cannot be made: {error.strerror}') from error
    if owner != os.getuid():
        raise InstallationError(f'{folder} belongs to another user')
    return folder
