"""The transport, the controller and the clock around a MotionPlanner, made by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from robots_core import Pose, load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import RobotsError
from robots_core.validation import Array
from robots_planning import MotionSettings, PathPlanning
from robots_planning.commands.command_queue import WINDOW
from robots_planning.commands.motion_plan import MotionPlan
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.motion_kinds import JOINT, LINE
from robots_planning.pathplanning import PlannedMotion
from robots_planning.trajectory import Trajectory

ROBOT = load_robot_model('ur10e')
START = np.array([0.2, -1.2, 1.6, -1.9, -1.4, 0.3])
PLAIN = MotionSettings()
MIDDLE = str(WINDOW // 2 - 1)
"""The id of the command in the middle of a full window of `Cell.bead`."""


@cache
def planning() -> PathPlanning:
    """One for all cells; it keeps planners, and no plans."""
    return PathPlanning(ROBOT)


class Cell:
    """The transport, the controller and the clock around a planner."""

    def __init__(self) -> None:
        self.now = 10.0
        self.q: Array | None = START
        self.q_dot = np.zeros(6)
        self.sent: list[tuple[str, PlannedMotion, str, float]] = []
        self.ends: list[Mapping[str, float]] = []
        self.answers: list[MotionResult] = []
        self.refusals: list[str] = []
        self.told: list[bool] = []
        self.patience: list[float] = []
        self.present = frozenset([b'first'])
        self.held_up = False
        self.planner = MotionPlanner(planning(), self)

    # -- port ---------------------------------------------------------------------------------------

    def time(self) -> float:
        return self.now

    def reference(self) -> tuple[Array, Array] | None:
        return None if self.q is None else (self.q, self.q_dot)

    def controllers(self) -> frozenset[bytes]:
        return self.present

    def missed(self) -> bool:
        return self.held_up

    def submit(self, work: Callable[[], None]) -> None:
        work()

    def release_after(self, patience: float) -> None:
        self.patience.append(patience)

    def send(self, plan: MotionPlan) -> None:
        assert plan.id in plan.ends
        assert tuple(plan.ends.values())[-1] == plan.motion.duration
        self.ends.append(plan.ends)
        self.sent.append((plan.id, plan.motion, plan.title, plan.join_time))

    def answer(self, result: MotionResult) -> None:
        self.answers.append(result)

    def refused(self, topic: str, error: RobotsError) -> None:
        self.refusals.append(f'{topic}: {error}')

    def finished(self, *, done: bool) -> None:
        self.told.append(done)

    # -- those around it ----------------------------------------------------------------------------

    def move(self, id_: str, offset: float, settings: MotionSettings = PLAIN) -> None:
        self.planner.command(id_, JOINT, START + offset, settings)

    def line(self, id_: str, dz: float, settings: MotionSettings = PLAIN) -> None:
        self.planner.command(id_, LINE, above(dz), settings)

    def bead(self, *numbers: int, last: bool = False, settings: MotionSettings = PLAIN) -> None:
        """Short blended joint motions there and back, aside a little each."""
        for number in numbers:
            offset = np.zeros(6)
            offset[[0, 1]] = 0.02 * (number + 1), 0.1 * (number % 2)
            zone = 0.0 if last and number == numbers[-1] else 0.02
            blended = replace(settings, joint_blend_zone=zone)
            self.planner.command(str(number), JOINT, START + offset, blended)

    def end(self, id_: str, *, ok: bool = True, **details: str) -> bool:
        self.now += 1.0
        return self.planner.result(MotionResult(id_, ok, 'reached' if ok else 'stopped', details), self.now)

    @property
    def ids(self) -> list[str]:
        return [id_ for id_, *_ in self.sent]

    def trajectory(self, number: int) -> Trajectory:
        return self.sent[number][1].trajectory


def above(dz: float) -> Pose:
    start = Pose(*ROBOT.direct_kinematics(START))
    return Pose(start.r + np.array([0.0, 0.0, dz]), start.T)
