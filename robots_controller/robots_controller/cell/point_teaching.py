"""PointTeaching: points of the open program, taught by a service."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.files.taught_points import SUFFIX
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.run_state import RunState
from robots_controller.program.teaching import Teaching, free_name
from robots_core.errors import NotNowError, ProgramError
from robots_core.robot_model.base_robot_model import BaseRobotModel

STANDING = 0.01  # rad/s (m/s) of measured axes, whose velocity is never quite 0


class PointTeaching:
    """Stores where the robot stands in the points file of the open program."""

    def __init__(self, robot: BaseRobotModel, program: LuaProgram) -> None:
        self._teaching, self._program = Teaching(robot), program

    def teach(self, name: str, measured: JointFeedback | None) -> str:
        """Teach a point; one that has the name is touched up.

        Args:
            name: Of the point; '' for the first of P1, P2, ... that is free.
            measured: What the robot measures; None for nothing yet.

        Returns:
            What has happened, for a person.

        Raises:
            NotNowError: the program runs, or the robot moves.
            ProgramError: no program is open, nothing is measured, or the points file is not valid; that stays
                as it is.
        """
        path = self._program.path
        if path is None:
            raise ProgramError('no program is open, whose point it would be; open one by ~/open')
        if self._program.run_state is RunState.RUNNING:
            raise NotNowError(f'{path.name} runs; pause or stop it, or let it teach by teach(name)')
        if measured is None:
            raise ProgramError('no joint_states received: is drive_node running?')
        if measured.velocity is not None and np.abs(measured.velocity).max() > STANDING:
            raise NotNowError('the robot moves; a point is taught where it stands')
        file: Path = self._program.points_file or path.with_suffix(SUFFIX)
        name = name or free_name(self._teaching.points(file))
        self._teaching.teach(file, name, measured.position)
        return f'{name} is where the robot stands, in {file.name}'
