"""The cell, as those who operate it see it: PendantPort of the operator's page, ProgramPort of others too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from robots_controller.io.io_image import Channel
from robots_controller.pendant.jog.jog_command import JogFrame
from robots_controller.pendant.motion_recording import MeasuredMotion
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import RobotsError
from robots_core.validation import Array


class ProgramPort(Protocol):
    """Commands that wait for an answer; they raise a RobotsError if the cell refuses or does not answer."""

    def call(self, service: str) -> str:
        """Call a std_srvs/Trigger service of the cell, such as 'lua_program_node/run'; its message."""

    def open_program(self, path: str) -> None:
        """Open a robot program."""

    def set_io(self, channel: Channel, value: float) -> None:
        """Give an output a value."""


class JogPort(Protocol):
    """Motions while a button is held; from any thread."""

    def jog_axes(self, velocity: Array) -> None:
        """Jog the axes with velocities (n,), rad/s (m/s), for the planner's timeout."""

    def jog_tool(self, twist: Array, frame: JogFrame) -> None:
        """Jog the tool with a twist (6,), m/s and rad/s, in 'tool' or 'base', for the planner's timeout."""

    def hold_run(self, *, held: bool) -> None:
        """Run is held, for the controller's timeout, or released."""

    def begin_move(self, command: MotionCommand, done: Callable[[RobotsError | None], None]) -> None:
        """Command a motion as the commander PENDANT.

        `done` is called from any thread when it has ended, with why it has not reached its target.
        """

    def end_move(self) -> None:
        """Stop the motion of `begin_move`, and give the robot back."""

    def reference(self) -> Array | None:
        """Where the robot shall be now, (n,), rad (m); None while no controller says so."""


class PendantPort(ProgramPort, JogPort, Protocol):
    """What else an operator commands. `set_parameters` and `force` wait for an answer, as `ProgramPort`."""

    def feedback(self) -> MeasuredMotion | None:
        """The newest measured positions and torques; None where there are none, or none are new."""

    def show_ghost(self, q: Array | None) -> None:
        """Show the robot in the 3D view at other joint positions too, (n,), rad (m); None: no more."""

    def set_override(self, value: float) -> None:
        """Set the speed override, 0..1."""

    def stop(self) -> None:
        """Stop the program and the robot."""

    def set_parameters(self, node: str, **values: object) -> None:
        """Set parameters of a node of the cell."""

    def force(self, channel: Channel, value: float | None) -> None:
        """Force an input to a value; None releases it."""
