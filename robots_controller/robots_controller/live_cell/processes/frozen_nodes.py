"""FrozenNodes: nodes of a cell whose processes live and do nothing any more."""

from collections.abc import Iterable
from typing import Final

from std_msgs.msg import UInt64

from robots_controller.live_cell.cell_monitor import CellMonitor
from robots_core.periodic.realtime import processor_share
from robots_core.periodic.watchdog import LONGEST, Watchdog
from robots_core.ros.peers.heartbeat import HEARTBEAT
from robots_core.ros.streams.polled_subscription import PolledSubscription

PATIENCE: Final = 10.0
"""Silence of so many times `watchdog`, which has stopped the robot long before, is no hold-up any more."""


class FrozenNodes:
    """Notices nodes that have given no sign of life for long; with a watchdog of 0 s, none."""

    def __init__(self, monitor: CellMonitor, names: Iterable[str], watchdog: float) -> None:
        self.timeout = min(PATIENCE * watchdog, LONGEST)
        """Silence of a node that is frozen, s."""
        self._beats = {
            name: PolledSubscription(monitor, UInt64, f'{name}/{HEARTBEAT}', raw=True)
            for name in (names if watchdog else ())
        }
        self._watchdogs: dict[str, Watchdog] = {}

    def started(self, name: str) -> None:
        """A node is restarted: its silence counts from its first sign of life on."""
        self._watchdogs.pop(name, None)

    def check(self, now: float) -> list[str]:
        """The nodes that are frozen since the last check, now in s."""
        found = []
        for name, beats in self._beats.items():
            watchdog = self._watchdogs.setdefault(name, Watchdog(self.timeout, processor_share))
            if watchdog.check(now, alive=beats.take() is not None):
                found.append(name)
        return found
