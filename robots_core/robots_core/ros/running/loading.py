"""Interrupts of a process that loads what its node is made of."""

import os
import signal
import sys

from robots_core.ros.running.interrupt import STOP_SIGNALS


def end_at_once_while_loading() -> None:
    """Let Ctrl-C and terminate end the process of a node, which has done nothing yet, without a word.

    Python's own way, an exception, is lost in imports that are tried with `except BaseException`, as trimesh
    tries many: the node would continue without the import and without having been interrupted. `run` has the
    signals from when it is called. Processes of other names, such as `cell`, are left alone.
    """
    if sys.argv[0].endswith(('_node', '_nodes')):
        for number in STOP_SIGNALS:
            signal.signal(number, lambda *_: os._exit(0))
