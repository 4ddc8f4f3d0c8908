"""WalkedCell: a simulated cell that knows which file of a program each motion is from."""

from __future__ import annotations

from typing import Any

from robots_controller.program.motion_command import MotionCommand
from robots_controller.simulation.simulated_cell import SimulatedCell
from robots_planning.robot_command_state import RobotCommandState


class WalkedCell(SimulatedCell):
    """A simulated cell that notes files; arguments as of `SimulatedCell`.

    Attributes:
        files: File of the program or subprogram that commanded a motion.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.files: dict[MotionCommand, str] = {}
        super().__init__(*arguments, **options)

    def _on_command(self, command: MotionCommand) -> None:
        self.files[command] = self._program.line_file
        super()._on_command(command)

    def _on_guided(self, state: RobotCommandState) -> None:
        # Nobody knows where a sensor or a person would lead the robot: it stands meanwhile.
        self._log.command_state(state.value)
