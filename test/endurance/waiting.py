"""Waiting for what another process does, on the wall clock."""

import time
from collections.abc import Callable
from typing import Final

POLL: Final = 0.02  # s


def happens(condition: Callable[[], object], within: float) -> bool:
    """Whether a condition is true now or becomes true within a time, s."""
    deadline = time.monotonic() + within
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(POLL)
    return True
