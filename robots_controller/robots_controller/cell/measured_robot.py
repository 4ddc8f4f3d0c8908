"""MeasuredRobot: the robot of a cell as its program reads it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from importlib import import_module
from typing import Any

from robots_controller.cell.ports import RobotPort
from robots_controller.program.cell_port import ProgramRobot
from robots_core.errors import ProgramError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings


class MeasuredRobot(ProgramRobot):
    """See `ProgramRobot`."""

    def __init__(self, robot: BaseRobotModel, port: RobotPort) -> None:
        self._robot, self._port = robot, port

    def joint_position(self) -> Array:
        """See `ProgramRobot`."""
        return self._port.joint_feedback().position

    def joint_speeds(self) -> Array:
        """See `ProgramRobot`."""
        velocity = self._port.joint_feedback().velocity
        if velocity is None:
            raise ProgramError('the robot measures no joint speeds: its joint_states have no velocity')
        return velocity

    def joint_torques(self) -> Array:
        """See `ProgramRobot`."""
        torque = self._port.joint_feedback().torque
        if torque is None:
            raise ProgramError(
                'the robot measures no torques: its joint_states have no effort; those of drives of level '
                'rigid_body do'
            )
        return torque

    def direct_kinematics(self, q: Array) -> Pose:
        """See `ProgramRobot`."""
        return self._robot.pose(q)

    def inverse_kinematics(self, pose: Pose, near: Array, settings: Mapping[str, object]) -> Array:
        """See `ProgramRobot`."""
        wanted: dict[str, Any] = dict(settings)
        q: Array = self._planning.reach(pose, near, MotionSettings(**wanted))
        return q

    @cached_property
    def _planning(self) -> Any:
        # Imported on demand: few programs ask for joint positions, and the planner takes long to load.
        return import_module('robots_planning.pathplanning').PathPlanning(self._robot)
