"""Scheduling and idle latency that a periodic thread requests; the system may refuse them."""

import math
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
PRESSURE = Path('/proc/pressure/cpu')
# A shorter time says little; in a longer one, more has happened than what is measured.
SHORTEST_STALL: Final = 0.005  # s
LONGEST_STALL: Final = 0.5  # s
CHECKS: Final = 10
BETWEEN_CHECKS: Final = 0.002  # s


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


class Stalls:
    """In which part of the time something has waited for a processor (Linux's pressure stall information)."""

    def __init__(self) -> None:
        self._last = -math.inf, 0.0, 1.0  # time of the last check, s; its total, s; the part before it

    def part(self) -> float:
        """Since the last check, 0 to 1; 1 if that is unknown."""
        now = time.monotonic()
        before, total_before, part = self._last
        if now - before < SHORTEST_STALL:
            return part
        try:
            total = 1e-6 * int(PRESSURE.read_text().partition('total=')[2].split()[0])
        except (OSError, IndexError, ValueError):  # another system, or switched off
            return 1.0
        known = now - before <= LONGEST_STALL
        part = min((total - total_before) / (now - before), 1.0) if known else 1.0
        self._last = now, total, part
        return part


_stalls = Stalls()


def processor_share(own: int = 1) -> float:
    """The share of a processor that each thread gets that could run, above 0 to 1 (Linux; elsewhere 1).

    By the number of those that can run, now or in the last minute, whichever is more. It counts for the part
    of the time since the last check in which something has waited, see `Stalls`.

    Args:
        own: How many of those that can run now do not count.
    """
    try:
        minute, _, _, now, _ = LOAD.read_text().split()
    except OSError:
        return 1.0
    runnable = max(float(minute), float(now.partition('/')[0]) - own)
    share = min(1.0, (os.cpu_count() or 1) / max(runnable, 1.0))
    return share if share == 1.0 else share + (1.0 - share) * (1.0 - _stalls.part())


def processor_share_in_silence() -> float:
    """The same, for a process that runs again after a silence: its own threads, which all can, do not count.

    The largest share of up to `CHECKS` checks: many threads can run for a moment when a process continues,
    and are no load. A check takes 20 us for each thread of the process.
    """
    largest = 0.0
    for check in range(CHECKS):
        if check:
            time.sleep(BETWEEN_CHECKS)
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

    Linux keeps to the smallest latency that any process requests as long as it does (its PM quality of
    service interface). The price is power: at 0 s no processor sleeps.

    Args:
        latency: Longest time to wake up, s; None requests nothing.

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
