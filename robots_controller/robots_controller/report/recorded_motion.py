"""RecordedMotion: one motion of a recorded run, from its start to its result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from robots_controller.recording import motion_record
from robots_controller.recording.motion_record import CommandRecord, MotionRecord
from robots_controller.report.tool_path import ToolPath
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

MOTION_TOPICS: Final = motion_record.MOTION_TOPICS


@dataclass(frozen=True, eq=False)
class RecordedMotion:
    """A motion command and what the robot did for it.

    Attributes:
        command: As it was commanded.
        start: When the robot could begin, s; NaN if nothing was planned.
        end: When it ended, or passed its target on the way to the next, s; NaN without a result.
        planned: Its part of the plan, s; NaN if nothing was planned.
        plan: The trajectory that it is a part of; None if nothing was planned.
        own: The robot stands at its end: no other motion follows in the plan.
    """

    command: CommandRecord
    start: float
    end: float
    planned: float
    plan: Trajectory | None
    own: bool

    @property
    def file(self) -> str:
        """The program that commanded it."""
        return self.command.file

    @property
    def line(self) -> int:
        """Its line there; 0 for none."""
        return self.command.line

    @property
    def kind(self) -> str:
        """What kind of motion it is."""
        return self.command.kind.title

    @property
    def ok(self) -> bool:
        """The robot came to its target, or through its zone."""
        return self.command.ok

    @property
    def message(self) -> str:
        """The result's text."""
        return self.command.message

    @property
    def cartesian(self) -> bool:
        """The tool follows a line, an arc or a spline."""
        return self.command.kind.cartesian

    @property
    def moved(self) -> bool:
        """It was planned and ended."""
        return bool(self.plan is not None and np.isfinite(self.end))


def recorded_motions(
    messages: Mapping[str, Sequence[tuple[float, Any]]],
    robot: BaseRobotModel,
    reference: tuple[Array, Array],
) -> tuple[RecordedMotion, ...]:
    """The motions of a bag.

    Motions that run through to the next share its trajectory; each ends where the references are nearest to
    its target.

    Args:
        messages: (s, message) of `MOTION_TOPICS`.
        robot: The robot.
        reference: Times (m,) s and positions (m, n) of the references.

    Raises:
        RobotsError: a command or a trajectory that makes no sense.
    """
    found: list[RecordedMotion] = []
    for motion in motion_record.recorded_motions(messages, robot):
        if motion.plan is None:
            found += [RecordedMotion(c, np.nan, np.nan, np.nan, None, own=True) for c in motion.commands]
            continue
        edges, parts = _edges(motion, motion.plan, robot, reference)
        found += [
            RecordedMotion(
                command,
                edges[number],
                edges[number + 1],
                parts[number],
                motion.plan,
                own=command is motion.commands[-1],
            )
            for number, command in enumerate(motion.commands)
        ]
    return tuple(found)


def _edges(
    motion: MotionRecord, plan: Trajectory, robot: BaseRobotModel, reference: tuple[Array, Array]
) -> tuple[list[float], list[float]]:
    """When each command begins, and the last one ends, s; and planned durations, s."""
    time, position = reference
    inside = np.flatnonzero((time >= motion.start) & (time <= motion.end))
    if inside.size and len(motion.commands) > 1:
        places = ToolPath(robot, position[inside]).passings(motion.commands)
        passed = [float(time[inside[place]]) for place in places]
        planned = plan.time[ToolPath(robot, plan.position).passings(motion.commands)].tolist()
    else:
        passed = [motion.end] * (len(motion.commands) - 1)
        planned = [plan.duration] * (len(motion.commands) - 1)
    ended = motion.end if motion.end > motion.start else np.nan
    return [motion.start, *passed, ended], np.diff([0.0, *planned, plan.duration]).tolist()
