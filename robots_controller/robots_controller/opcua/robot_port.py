"""RobotPort: the cell, as clients of the OPC UA server command it."""

from __future__ import annotations

from typing import Protocol

from robots_controller.io.io_image import Channel


class RobotPort(Protocol):
    """Commands that wait for an answer; they raise a RobotsError if the cell refuses or does not answer."""

    def call(self, service: str) -> None:
        """Call a std_srvs/Trigger service of the cell, such as 'lua_program_node/run'."""

    def open_program(self, path: str) -> None:
        """Open a robot program."""

    def set_io(self, channel: Channel, value: float) -> None:
        """Give an output a value."""
