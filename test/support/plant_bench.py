"""An I/O map with protocols at work without ROS: the test is the robot, and hands in the time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from unittest.mock import patch

from read_texts import parse_io_map
from robots_controller.io.bridge.io_bridge import IoBridge
from robots_controller.io.io_image import Channel
from robots_controller.io.io_map import IoMap
from robots_controller.io.plant import plant_connection
from robots_controller.io.plant.plant_connection import connect

DEADLINE = 120.0  # s


class PlantBench:
    """The rows of a map, connected as the node connects them.

    Args:
        text: The map.
        pause: Longest pause between attempts to connect, s.
    """

    def __init__(self, text: str, *, pause: float = 0.05) -> None:
        self.io_map: IoMap = parse_io_map(text)
        self._woken = threading.Event()
        self.now = 0.0
        """Handed in as the time, s."""
        self.checks = 0
        """How often an input's value was asked for: after each arrival, and when it may change without."""
        self.told: list[str] = []
        self.outputs: dict[str, float] = {}
        self.inputs: dict[str, float] = {}
        self._pauses = patch.multiple(
            plant_connection, FIRST_PAUSE=pause, LONGEST_PAUSE=pause, RETRY_PERIOD=pause
        )
        self._pauses.start()
        rows = (*self.io_map.inputs, *self.io_map.outputs)
        self.ports = {
            name: connect(server, [row for row in rows if row.place.port == name], self._woken.set)
            for name, server in self.io_map.servers.items()
        }
        self.bridge = IoBridge(self.io_map, self.ports, self.io_map.fail_safe, self.told.append, self.now)

    def value(self, channel: Channel) -> float | None:
        """Of an output."""
        return self.outputs.get(channel.name)

    def absent_for(self, channel: Channel, now: float) -> float:
        """Images of the outputs never fail here."""
        del channel, now
        return 0.0

    def step(self) -> None:
        """What the node does once."""
        for channel, value in self.bridge.take_inputs(self.now):
            self.inputs[channel.name] = value
            self.checks += 1
        for port in self.ports.values():
            self.told += port.news()

    def switch(self, **values: float) -> None:
        """Set outputs, as d1=1.0 or a2=0.5, in one image."""
        kinds = {'d': 'digital', 'a': 'analog'}
        self.outputs |= {f'{kinds[key[0]]}_output.{key[1:]}': value for key, value in values.items()}
        self.bridge.send_outputs(self, self.now, lost=False)

    def until(self, condition: Callable[[], object], what: str) -> None:
        """Work until something is so."""
        end = time.monotonic() + DEADLINE
        while True:
            self._woken.clear()
            self.step()
            if condition():
                return
            assert time.monotonic() < end, f'{what}; problems: {self.bridge.problems}; told: {self.told}'
            self._woken.wait(0.02)

    def woken(self) -> bool:
        """A port has asked for a turn of the loop since the last call."""
        woken = self._woken.is_set()
        self._woken.clear()
        return woken

    def works_while_it_waits(self, port: str, hold: Callable[[], None], **values: float) -> None:
        """While a port waits for an answer that does not come, the loop has its turns."""
        connection = self.ports[port]
        hold()
        self.switch(**values)
        self.until(lambda: connection._busy or connection._waiting, 'a write that is not confirmed')
        for _ in range(100):
            self.step()
        assert connection._busy or connection._waiting

    def close(self) -> None:
        """End the connections."""
        for port in self.ports.values():
            port.close()
        self._pauses.stop()
