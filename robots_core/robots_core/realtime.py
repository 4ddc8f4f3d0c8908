"""What a thread that keeps time asks of the system, which may not permit it."""

import os
import struct
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

IDLE_LATENCY_DEVICE = Path('/dev/cpu_dma_latency')


def ask_for_realtime(priority: int) -> bool:
    """Ask the system for first-in-first-out scheduling of the calling thread.

    Args:
        priority: 1 to 99.

    Returns:
        True if the system permits it; otherwise the thread runs as before.
    """
    try:
        os.sched_setscheduler(threading.get_native_id(), os.SCHED_FIFO, os.sched_param(priority))
    except PermissionError:
        return False
    return True


@contextmanager
def idle_latency(latency: float | None) -> Iterator[bool]:
    """Keep idle processors, all of them, from sleeping so deeply that they wake up late.

    Linux keeps to the smallest latency that any process asks for as long as it does (its PM quality of
    service interface). The price is power: at 0 s no processor sleeps.

    Args:
        latency: Longest time to wake up, s; None asks for nothing.

    Yields:
        True if the system permits it; the request holds inside the context.
    """
    with ExitStack() as held:
        granted = False
        if latency is not None:
            try:
                request = held.enter_context(IDLE_LATENCY_DEVICE.open('wb', buffering=0))
                request.write(struct.pack('i', round(1e6 * latency)))
                granted = True
            except OSError:  # another system, or not this user's to ask
                pass
        yield granted
