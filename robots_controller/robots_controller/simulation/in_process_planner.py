"""InProcessPlanner: the planner in one process with the program and the controller."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final

import numpy as np

from robots_controller.cell.ports import Configured, PlannerPort
from robots_controller.control.control_loop import ControlLoop
from robots_controller.program.motions.modal_settings import PLANNING_NODE, motion_settings, without_blend
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.record.cell_log import CellLog
from robots_controller.simulation.record.ros_messages import id_of
from robots_controller.simulation.simulated_clock import SimulatedClock
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning, PlannedMotion
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.trajectory_generator import Target

Mail = deque[Callable[[], None]]
"""What was sent and is not delivered yet, in the order in which it was sent."""


class InProcessPlanner(PlannerPort):
    """Both ends of the messages between program, planner and controller: `PlannerPort`, `MotionPlannerPort`.

    Args:
        planning: Plans.
        payload: What the robot carries where the program does not say it.
        mail: Carries the messages.
        clock: Simulated time.
        control: Follows the plans.
        log: Gets the messages.
        cost: Gets the time that planning takes.
    """

    def __init__(
        self,
        planning: PathPlanning,
        *,
        payload: tuple[float, ...],
        mail: Mail,
        clock: SimulatedClock,
        control: ControlLoop,
        log: CellLog,
        cost: Cost,
    ) -> None:
        self._mail, self._clock, self._control = mail, clock, control
        self._log, self._cost = log, cost
        self.planner = MotionPlanner(planning, self)
        self._defaults = {'payload': payload}
        self.planner.settings = motion_settings(self._defaults)
        self._configured: dict[str, object] = {}
        self._last_id = 0
        self.on_result: Callable[[MotionResult], None] = lambda _: None
        """Gets the results that the planner sends."""
        self.on_planned: Callable[[str, Mapping[str, float], Trajectory], None] = lambda *_: None
        """Gets each plan with its id and the ends of its commands."""
        self.on_settings: Callable[[MotionSettings], None] = lambda _: None
        """Gets the modal settings whenever they are set."""

    name: Final = PLANNING_NODE

    # -- the program's end ----------------------------------------------------------------------------

    def differs(self, settings: Mapping[str, object]) -> bool:
        """See `PlannerPort`."""
        return dict(settings) != self._configured

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:  # noqa: ARG002
        """See `PlannerPort`."""
        self._mail.append(partial(self._configure, dict(settings), done))

    def flush(self, settings: Mapping[str, object]) -> None:
        """See `PlannerPort`."""
        self.configure(without_blend(settings), lambda _: None, moving=True)

    def next_id(self) -> str:
        """See `PlannerPort`; unique even while time stands still."""
        self._last_id = max(self._clock.stamp, self._last_id + 1)
        return id_of(self._last_id)

    def command(self, id_: str, command: MotionCommand) -> None:
        """See `PlannerPort`."""
        settings = self.planner.settings
        self._log.command(id_, command, settings)
        plan = partial(self.planner.command, id_, command.kind, _target(command), settings)
        self._mail.append(partial(self._plan, plan))

    def followers(self) -> Mapping[bytes, str]:
        """This process: see `PlannerPort`."""
        return {b'': 'simulation'}

    # -- the planner's end ----------------------------------------------------------------------------

    def time(self) -> float:
        """See `MotionPlannerPort`."""
        return self._clock.now()

    def reference(self) -> tuple[Array, Array] | None:
        """See `MotionPlannerPort`."""
        reference = self._control.controller.reference
        return None if reference is None else (np.array(reference[0]), reference[1])

    def controllers(self) -> frozenset[bytes]:
        """See `MotionPlannerPort`: always the same one."""
        return frozenset()

    def missed(self) -> bool:
        """Never: see `MotionPlannerPort`."""
        return False

    def submit(self, work: Callable[[], None]) -> None:
        """Now: see `MotionPlannerPort`."""
        work()

    def release_after(self, patience: float) -> None:
        """Never: a program says when nothing follows."""

    def send(
        self,
        id_: str,
        motion: PlannedMotion,
        ends: Mapping[str, float],
        *,
        title: str,  # noqa: ARG002
        join_time: float,
    ) -> None:
        """See `MotionPlannerPort`."""
        trajectory = motion.trajectory
        self._log.planned(id_, ends, motion, join_time)
        self._control.follow(_as_in_message(trajectory), id_, join_time=join_time)
        self._mail.append(lambda: self.on_planned(id_, ends, trajectory))

    def answer(self, result: MotionResult) -> None:
        """See `MotionPlannerPort`."""
        self._log.report('motion_result', result.status)
        self._mail.append(lambda: self.on_result(result))

    def refused(self, topic: str, error: RobotsError) -> None:
        """See `MotionPlannerPort`; the result says it."""

    def finished(self, *, done: bool) -> None:
        """See `MotionPlannerPort`."""
        self._log.value('finished', done)

    # -- inside ---------------------------------------------------------------------------------------

    def _configure(self, settings: dict[str, object], done: Configured) -> None:
        try:
            wanted = motion_settings({**self._defaults, **settings})
        except PlanningError as error:
            done(error)
            return
        self._configured = settings
        self._log.settings(wanted)
        self._plan(partial(self.planner.configure, wanted))
        self.on_settings(wanted)
        done(None)

    def _plan(self, work: Callable[[], object]) -> None:
        before = self._cost.switch('planning')
        work()
        self._cost.switch(before)


def _target(command: MotionCommand) -> Target:
    target = command.target
    if isinstance(target, Pose):
        return _through_message(target)
    return tuple(map(_through_message, target)) if isinstance(target, tuple) else target


def _through_message(pose: Pose) -> Pose:
    # Quaternions round a little: the planner gets to the last digit what it gets in a live cell.
    return Pose.from_quaternion(pose.r, pose.quaternion())


def _as_in_message(trajectory: Trajectory) -> Trajectory:
    time = Trajectory.message_times(trajectory.time)
    if np.array_equal(time, trajectory.time):
        return trajectory
    return Trajectory(time, trajectory.position, trajectory.velocity, trajectory.acceleration)
