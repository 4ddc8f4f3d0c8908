"""Ends the fork server with its cell while it loads, when it notices nothing itself; imported by it first."""

import ctypes
import signal
from typing import Final

PR_SET_PDEATHSIG: Final = 1
"""Of Linux: the signal that a process gets when the thread that started it has ended; 0 for none."""


def on_parent_end(number: int) -> None:
    """Choose this signal of this process."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, number)


on_parent_end(signal.SIGKILL)
