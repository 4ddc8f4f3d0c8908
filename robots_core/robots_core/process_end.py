"""The end of a process: without what takes long and helps nobody, and whatever the middleware does."""

import atexit
import faulthandler
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

STDERR: Final = 2
"""Its descriptor, whatever `sys.stderr` is."""
END_DEADLINE = 20.0  # s


def end_quickly() -> None:
    """Let this process end without a search for garbage in all that it has loaded: that takes 0.5 s."""
    atexit.register(_keep_garbage)


def _keep_garbage() -> None:
    # nanobind, by which Ruckig is bound, prints a list of what was kept.
    if 'ruckig' in sys.modules:
        gc.unfreeze()
    else:
        gc.freeze()


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
