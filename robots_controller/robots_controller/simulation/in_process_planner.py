"""InProcessPlanner: the planner in one process with the program and the controller."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from robots_controller.cell.ports import Configured, PlannerPort
from robots_controller.program.motions.modal_settings import PLANNING_NODE, motion_settings, without_blend
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.simulation.record.ros_messages import id_of
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.commands.command_planner import MotionPlannerPort
from robots_planning.commands.motion_plan import MotionPlan
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.pathplanning import PathPlanning
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.trajectory_generator import Target

if TYPE_CHECKING:
    from robots_controller.simulation.in_process_cell import InProcessCell


class InProcessPlanner(PlannerPort, MotionPlannerPort):
    """Both ends of the messages between program, planner and controller."""

    def __init__(self, cell: InProcessCell, planning: PathPlanning, payload: tuple[float, ...]) -> None:
        self._cell, self._control = cell, cell.control.loop
        self._mail, self._clock, self._log = cell.mail, cell.clock, cell.log
        self.planner = MotionPlanner(planning, self)
        self._defaults = {'payload': payload}
        self.planner.settings = motion_settings(self._defaults)
        self._configured: dict[str, object] = {}
        self._last_id = 0

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

    def submit(self, work: Callable[[], None]) -> None:
        """Now: see `MotionPlannerPort`."""
        work()

    def send(self, plan: MotionPlan) -> None:
        """See `MotionPlannerPort`."""
        self._log.planned(plan)
        self._control.follow(_as_in_message(plan.trajectory), plan.id, join_time=plan.join_time)
        self._mail.append(partial(self._cell.motion_planned, plan))

    def answer(self, result: MotionResult) -> None:
        """See `MotionPlannerPort`."""
        self._log.report('motion_result', result.status)
        self._mail.append(partial(self._cell.motion_ended, result))

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
        self._cell.settings_changed(wanted)
        done(None)

    def _plan(self, work: Callable[[], object]) -> None:
        before = self._cell.cost.switch('planning')
        work()
        self._cell.cost.switch(before)


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
    return trajectory if np.array_equal(time, trajectory.time) else replace(trajectory, time=time)
