"""PendantPort: the cell, as the operator's page sees it."""

from __future__ import annotations

from typing import Protocol

from robots_controller.io.io_image import Channel
from robots_controller.pendant.jog_command import JogFrame
from robots_core.operating_modes import OperatingMode
from robots_core.validation import Array


class PendantPort(Protocol):
    """Commands of an operator. Methods of the second group wait for an answer and raise a RobotsError."""

    def jog_axes(self, velocity: Array) -> None:
        """Jog the axes with velocities (n,), rad/s (m/s), for the planner's timeout."""

    def jog_tool(self, twist: Array, frame: JogFrame) -> None:
        """Jog the tool with a twist (6,), m/s and rad/s, in 'tool' or 'base', for the planner's timeout."""

    def hold_run(self, *, held: bool) -> None:
        """Run is held, for the controller's timeout, or released."""

    def set_override(self, value: float) -> None:
        """Set the speed override, 0..1."""

    def stop(self) -> None:
        """Stop the program and the robot."""

    # -- with an answer -----------------------------------------------------------------------------------

    def call(self, service: str) -> None:
        """Call a std_srvs/Trigger service of the cell, such as 'lua_program_node/run'."""

    def open_program(self, path: str) -> None:
        """Open a robot program."""

    def set_mode(self, mode: OperatingMode) -> None:
        """Set the operating mode."""

    def set_io(self, channel: Channel, value: float) -> None:
        """Give an output a value."""

    def force(self, channel: Channel, value: float | None) -> None:
        """Force an input to a value; None releases it."""
