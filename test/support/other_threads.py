"""A second thread that takes turns with a test as often as Python lets it."""

import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Final

SWITCH_INTERVAL: Final = 1e-6  # s


@contextmanager
def repeating(call: Callable[[], object]) -> Iterator[None]:
    """Repeat a call in another thread until the block ends; an exception of it is raised then."""
    done = threading.Event()

    def repeat() -> None:
        while not done.is_set():
            call()

    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL)
    try:
        with ThreadPoolExecutor() as threads:
            repeated = threads.submit(repeat)
            try:
                yield
            finally:
                done.set()
    finally:
        sys.setswitchinterval(before)
    repeated.result()
