"""Interrupt: Ctrl-C and terminate as an event that is asked for, not an exception out of nowhere."""

import contextlib
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator

STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextlib.contextmanager
def interrupt(wake: Callable[[], None]) -> Iterator[threading.Event]:
    """An event that is set by Ctrl-C or terminate while the context lasts; for the main thread.

    An exception raised by a signal handler can strike inside compiled code, which then reports something
    else or leaves half of its work. So nothing is raised: spinning ends between two callbacks. Ctrl-C
    in a terminal reaches a launched process twice; the second changes nothing, afterwards too: the process is
    about to end.

    Args:
        wake: Called, by a thread, once the event is set: ends waiting elsewhere.
    """
    stopping = threading.Event()
    reader, writer = socket.socketpair()
    writer.setblocking(False)

    def watch() -> None:
        # The handler of a signal runs when the main thread is back in Python; this byte comes at once.
        if reader.recv(1) != b'\0':
            stopping.set()
            wake()

    before = {number: signal.signal(number, lambda *_: None) for number in STOP_SIGNALS}
    descriptor = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    watcher = threading.Thread(target=watch, name='interrupt', daemon=True)
    watcher.start()
    try:
        yield stopping
    finally:
        signal.set_wakeup_fd(descriptor)
        for number, handler in before.items():
            signal.signal(number, signal.SIG_IGN if stopping.is_set() else handler)
        with contextlib.suppress(BlockingIOError):
            writer.send(b'\0')
        watcher.join()
        reader.close()
        writer.close()


def end_at_once_while_loading() -> None:
    """Let Ctrl-C and terminate end the process of a node, which has done nothing yet, without a word.

    Python's own way, an exception, is lost in imports that are tried with `except BaseException`, as trimesh
    tries many: the node would continue without the import and without having been interrupted. `run` has the
    signals from when it is called. Processes of other names, such as `cell`, are left alone.
    """
    if sys.argv[0].endswith(('_node', '_nodes')):
        for number in STOP_SIGNALS:
            signal.signal(number, lambda *_: os._exit(0))
