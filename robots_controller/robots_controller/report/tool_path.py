"""ToolPath: where a robot had its tool, compared with where motions should lead it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from robots_controller.recording.motion_record import CommandRecord
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

TURN_LENGTH: Final = 0.1  # m/rad: how an angle counts among distances where the nearest place is looked for


class ToolPath:
    """Postures of a robot in turn, and where it had which tool.

    Args:
        robot: The robot.
        q: Joint positions, (m, n).
    """

    def __init__(self, robot: BaseRobotModel, q: Array) -> None:
        self._robot, self._q = robot, q
        frames = [robot.direct_kinematics(row) for row in q]
        self._r = np.array([frame[0] for frame in frames])
        self._T = np.array([frame[1] for frame in frames])

    def passings(self, commands: Sequence[CommandRecord]) -> list[int]:
        """Where it is nearest to the targets of all commands but the last, in turn."""
        places, first = [], 0
        for command in commands[:-1]:
            target, tool = command.tool_target, command.settings.tool_pose
            r = self._r[first:] + self._T[first:] @ tool.r
            # The cosine of the angle between two orientations is in the trace of their quotient.
            trace = np.einsum('mij,ij->m', self._T[first:], command.pose.T)
            angle = np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0))
            first += int(np.argmin(np.linalg.norm(r - target.r, axis=1) + TURN_LENGTH * angle))
            places.append(first)
        return places

    def distance(self, place: int, command: CommandRecord) -> float:
        """How far it is from the target of a command there, in the unit of its zone."""
        return float(self._distances(slice(place, place + 1), place, command)[0])

    def line_deviation(
        self, begin: int, end: int, before: CommandRecord | None, command: CommandRecord, *, stands: bool
    ) -> float:
        """Largest distance from the straight line to the target, outside the zones, m."""
        tool = command.settings.tool_pose
        rows = slice(begin, end + 1)
        r = self._r[rows] + self._T[rows] @ tool.r
        start = r[0] if before is None else (before.pose @ tool).r
        way = command.tool_target.r - start
        squared = float(way @ way)
        part = np.clip((r - start) @ way / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(r))
        away = np.linalg.norm(r - start - part[:, None] * way, axis=1)
        outside = np.ones(len(r), dtype=bool)
        for corner, place in ((before, begin), (None if stands else command, end)):
            if corner is not None:
                outside &= self._distances(rows, place, corner) > corner.zone[0]
        return float(away[outside].max(initial=0.0))

    def _distances(self, rows: slice, place: int, command: CommandRecord) -> Array:
        """Distances of some postures from the target that is passed at a place, in the unit of its zone."""
        if not command.zone[1]:
            tool = command.settings.tool_pose
            return np.asarray(
                np.linalg.norm(self._r[rows] + self._T[rows] @ tool.r - command.tool_target.r, axis=1)
            )
        corner = command.q
        if corner is None:  # the posture of the target, where the robot was when it passed
            corner = DampedLeastSquares(self._robot).solve(command.pose, self._q[place]).q
        return np.asarray(np.abs(self._q[rows] - corner).max(axis=1))
