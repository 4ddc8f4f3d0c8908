"""ROS domains that nothing else on this machine uses now."""

import fcntl
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Final

from robots_core.ros.running.middleware import LOOPBACK

# Above 101 the ports of a domain fall into Linux' range of ephemeral ports.
DOMAIN_IDS: Final = range(1, 101)
DOMAIN_DEADLINE: Final = 60.0  # s
POLL: Final = 0.02  # s


@contextmanager
def reserved_domain() -> Iterator[dict[str, str]]:
    """A domain, by locks that all users of this function share.

    Yields:
        The environment of its nodes.

    Raises:
        TimeoutError: none is free.
    """
    folder = Path(tempfile.gettempdir()) / 'robots_test_domains'
    folder.mkdir(exist_ok=True)
    deadline = time.monotonic() + DOMAIN_DEADLINE
    with ExitStack() as held:
        while True:
            for domain in DOMAIN_IDS:
                # The file is never removed: a lock on a removed file would protect nothing.
                lock = (folder / f'{domain}.lock').open('w')
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    lock.close()
                    continue
                held.enter_context(lock)
                # As the nodes choose themselves.
                yield {'ROS_DOMAIN_ID': str(domain), **LOOPBACK}
                return
            if time.monotonic() > deadline:
                raise TimeoutError(f'no free ROS domain within {DOMAIN_DEADLINE:g} s, locks are in {folder}')
            time.sleep(POLL)
