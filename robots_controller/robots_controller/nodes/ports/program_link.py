"""ProgramLink: the robot program and the outputs of a cell, by its services."""

from __future__ import annotations

from robots_controller.client.cell_services import CellServices
from robots_controller.client.io_client import IoClient
from robots_controller.client.program_client import open_program
from robots_controller.io.io_image import Channel
from robots_core.ros.robot_node import RobotNode


class ProgramLink:
    """See `ProgramPort`; safe from any thread but the node's own.

    Args:
        node: The node to call from; another thread spins it.
        patience: Longest wait for an answer, s.
    """

    def __init__(self, node: RobotNode, patience: float) -> None:
        self._services = CellServices(node, patience)
        self._io = IoClient(self._services)
        self.call = self._services.trigger

    def open_program(self, path: str) -> None:
        """See `ProgramPort`."""
        open_program(self._services, path)

    def set_io(self, channel: Channel, value: float) -> None:
        """See `ProgramPort`."""
        self._io[channel.name] = bool(value) if channel.kind == 'digital' else float(value)
