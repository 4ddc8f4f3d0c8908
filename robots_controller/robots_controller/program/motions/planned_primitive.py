"""Motions of a program as primitives for the robot's own controller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from robots_controller.program.motions.modal_settings import motion_settings
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.commands.motion_primitives import MotionPrimitive
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE
from robots_planning.pathplanning import PathPlanning, in_base
from robots_planning.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class PlannedPrimitive:
    """A motion that the robot's own controller plans, and what it is expected to be.

    Attributes:
        id: Of its command.
        primitive: What the driver gets.
        trajectory: The motion as it is planned here. The robot takes the same path, at speeds of its own.
        tool: Tool centre point in tool0.
    """

    id: str
    primitive: MotionPrimitive
    trajectory: Trajectory
    tool: Pose

    def progress(self, q: Array, since: float = 0.0) -> float:
        """Part of the motion's time, from `since` on, when it is closest to joint positions (n,), rad (m)."""
        time, duration = self.trajectory.time, self.trajectory.duration
        ahead = np.flatnonzero(time >= since * duration)
        if duration <= 0.0 or not ahead.size:
            return 1.0
        off = np.abs(self.trajectory.position[ahead] - q).max(axis=1)
        return float(time[ahead[off.argmin()]] / duration)

    def rest(self, robot: BaseRobotModel, q: Array) -> PlannedPrimitive:
        """What is left from a posture on the path, (n,); an arc gets another point on the way."""
        target = self.primitive.target
        if not isinstance(target, tuple):
            return self
        middle = 0.5 * (1.0 + self.progress(q)) * self.trajectory.duration
        posture = self.trajectory.sample(np.array([middle]))[0][0]
        via = robot.pose(posture) @ self.tool
        return replace(self, primitive=replace(self.primitive, target=(via, target[-1])))

    def scaled(self, override: float, *, last: bool) -> MotionPrimitive:
        """The primitive at a part of its velocity, in (0, 1]; the last of a sequence stops at its end."""
        primitive = self.primitive
        arguments = {**primitive.arguments, 'velocity': override * primitive.arguments['velocity']}
        return replace(primitive, arguments=arguments, blend_radius=0.0 if last else primitive.blend_radius)


class PrimitivePlanner:
    """Plans the motions of a program, and gives them as primitives if they keep the limits of the robot."""

    def __init__(self, robot: BaseRobotModel, driver: str) -> None:
        self._robot, self._driver = robot, driver
        self._planning = PathPlanning(robot)

    def plan(
        self, id_: str, command: MotionCommand, settings: Mapping[str, object], start: Array
    ) -> PlannedPrimitive:
        """The primitive of a command.

        Args:
            id_: Of the command.
            command: Of a program.
            settings: Its modal settings, by name.
            start: Joint positions where the motion begins, (n,), rad (m).

        Raises:
            RobotsError: as `PathPlanning.plan`, or no primitive can do it.
        """
        wanted = motion_settings(settings, self._driver)
        if wanted.avoid:
            raise PlanningError(
                f'{self._driver} cannot go around obstacles (avoid); a driver that takes trajectories can'
            )
        kind, target = command.kind, command.target
        if kind is JOINT_TO_POSE:
            assert isinstance(target, Pose)
            kind, target = JOINT, self._planning.reach(target, start, wanted)
        planned = self._planning.plan(kind, start, target, wanted)
        primitive = MotionPrimitive.commanded(self._robot, kind, in_base(kind, target, wanted), wanted)
        return PlannedPrimitive(id_, primitive, planned.trajectory, wanted.tool_pose)
