"""An end that the middleware cannot hold up for ever."""

import faulthandler
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

STDERR: Final = 2
"""Its descriptor, whatever `sys.stderr` is."""
END_DEADLINE = 20.0  # s


@contextmanager
def bounded_end() -> Iterator[None]:
    """End nodes inside; after `END_DEADLINE` the process ends with 1 and the stacks of all threads.

    Fast DDS 2.14 can wait without end for a participant that leaves while its own is destroyed, and rclpy
    does not let other threads run Python meanwhile: only compiled code can end the process.
    """
    faulthandler.dump_traceback_later(END_DEADLINE, exit=True, file=STDERR)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
