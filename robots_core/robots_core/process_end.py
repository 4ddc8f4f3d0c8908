"""The end of a process, without what takes long and helps nobody."""

import atexit
import gc
import sys


def end_quickly() -> None:
    """Let this process end without a search for garbage in all that it has loaded: that takes 0.5 s."""
    atexit.register(_keep_garbage)


def _keep_garbage() -> None:
    # nanobind, by which Ruckig is bound, prints a list of what was kept.
    if 'ruckig' in sys.modules:
        gc.unfreeze()
    else:
        gc.freeze()
