"""Scheduling and idle latency that a periodic thread requests; the system may refuse them."""

import os
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Final

IDLE_LATENCY_DEVICE = Path('/dev/cpu_dma_latency')
LOAD = Path('/proc/loadavg')
TASKS = Path('/proc/self/task')
LOOKS: Final = 10
BETWEEN_LOOKS: Final = 0.002  # s


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


def processor_share(own: int = 1) -> float:
    """The share of a processor that each thread gets that could run now, above 0 to 1.

    By the number of those that can run, now or in the last minute, whichever is more (Linux; elsewhere 1).

    Args:
        own: How many of those that can run now do not count.
    """
    try:
        minute, _, _, now, _ = LOAD.read_text().split()
    except OSError:
        return 1.0
    runnable = max(float(minute), float(now.partition('/')[0]) - own)
    return min(1.0, (os.cpu_count() or 1) / max(runnable, 1.0))


def processor_share_in_silence() -> float:
    """The same, for a process that runs again after a silence: its own threads, which all can, do not count.

    The largest share of up to `LOOKS` looks: many threads can run for a moment when a process continues, and
    are no load. A look takes 20 us for each thread of the process.
    """
    largest = 0.0
    for look in range(LOOKS):
        if look:
            time.sleep(BETWEEN_LOOKS)
        own = sum(map(_runs, TASKS.iterdir())) if TASKS.is_dir() else 1
        largest = max(largest, processor_share(max(1, own)))
        if largest == 1.0:
            break
    return largest


def _runs(thread: Path) -> bool:
    try:
        return (thread / 'stat').read_text().rpartition(')')[2].split()[0] == 'R'
    except OSError:  # it has ended
        return False


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
