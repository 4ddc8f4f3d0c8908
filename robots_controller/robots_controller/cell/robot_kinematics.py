"""RobotKinematics: the kinematics of a cell's robot as its program uses them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from importlib import import_module
from typing import Any

from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings


class RobotKinematics:
    """See `ProgramKinematics`."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot

    def direct(self, q: Array) -> Pose:
        """See `ProgramKinematics`."""
        return self._robot.pose(q)

    def inverse(self, pose: Pose, near: Array, settings: Mapping[str, object]) -> Array:
        """See `ProgramKinematics`."""
        wanted: dict[str, Any] = dict(settings)
        q: Array = self._planning.reach(pose, near, MotionSettings(**wanted))
        return q

    @cached_property
    def _planning(self) -> Any:
        # Imported on demand: few programs ask for joint positions, and the planner takes long to load.
        return import_module('robots_planning.pathplanning').PathPlanning(self._robot)
