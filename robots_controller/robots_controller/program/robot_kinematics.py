"""RobotKinematics: the kinematics of a cell's robot as its program uses them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from importlib import import_module
from typing import Any

from robots_controller.program.motions.modal_settings import motion_settings
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class RobotKinematics:
    """Called from the program's thread."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot

    def direct(self, q: Array) -> Pose:
        """Pose of tool0 in the base frame for joint positions (n,), rad (m)."""
        return self._robot.pose(q)

    def inverse(self, pose: Pose, near: Array, settings: Mapping[str, object]) -> Array:
        """Joint positions (n,) that a joint motion to a pose would lead to, rad (m).

        Args:
            pose: Of the tool, seen from the base that was set.
            near: Joint positions (n,) to search from, rad (m).
            settings: Modal settings that the program has changed.

        Raises:
            PlanningError: the settings are not valid.
            UnreachablePoseError: there are none inside the limits.
        """
        q: Array = self._planning.reach(pose, near, motion_settings(settings))
        return q

    @cached_property
    def _planning(self) -> Any:
        # Imported on demand: few programs ask for joint positions, and the planner takes long to load.
        return import_module('robots_planning.pathplanning').PathPlanning(self._robot)
