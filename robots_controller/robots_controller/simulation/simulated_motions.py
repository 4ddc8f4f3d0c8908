"""SimulatedMotions: commands on their way through planner and controller, without messages between."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

import numpy as np

from robots_controller.control.controller import Controller
from robots_controller.program.motion_command import MotionCommand
from robots_controller.simulation.simulation_run import SimulatedMotion
from robots_core.errors import PlanningError, RobotsError
from robots_core.motion_result import MotionResult
from robots_core.pose import Pose
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array
from robots_planning.command_planner import CommandPlanner, PlannedCommands
from robots_planning.command_queue import CommandQueue, QueuedCommand, RunningMotion
from robots_planning.motion_results import PASSED
from robots_planning.motion_settings import CHECKS, MotionSettings
from robots_planning.pathplanning import PathPlanning, Target
from robots_planning.standing_robot import check_standing
from robots_planning.trajectory import Trajectory


@dataclass(frozen=True)
class MotionEnd:
    """A motion command has its result.

    Attributes:
        id: The command.
        command: The same as the program gave it.
        ok: The robot stands at the target, or has passed it.
        message: 'reached', 'passed', or why not.
        details: Further facts.
    """

    id: str
    command: MotionCommand
    ok: bool
    message: str
    details: Mapping[str, object]

    @property
    def error(self) -> RobotsError | None:
        """What the program is told."""
        if self.ok:
            return None
        error = RobotsError(self.message)
        error.details.update({key: str(value) for key, value in self.details.items()})
        return error


class SimulatedMotions:
    """Plans the program's commands, hands the plans to the controller and tells how they end.

    Args:
        planning: Plans.
        controller: Follows.
        axes: The robot's.
        now: Time, s.
        on_planned: A plan goes to the controller.
        on_end: A command has its result.
    """

    def __init__(
        self,
        planning: PathPlanning,
        controller: Controller,
        axes: AxesData,
        *,
        now: Callable[[], float],
        on_planned: Callable[[PlannedCommands], None],
        on_end: Callable[[MotionEnd], None],
    ) -> None:
        self._controller, self._axes, self._now = controller, axes, now
        self._on_planned, self._on_end = on_planned, on_end
        self._book = CommandQueue()
        self._planner = CommandPlanner(
            planning,
            self._book,
            standing=self._standing,
            path_time=lambda: 0.0,  # only of who replaces motions, which programs do not
            send=self._send,
            refuse=self._refuse,
        )
        # The order of commands and failures in which the book thinks: time stands still between them.
        self._order = count(1)
        self.commands: dict[str, MotionCommand] = {}
        """Those without a result, by id, oldest first."""
        self._records: dict[str, SimulatedMotion] = {}
        self._to_controller: deque[PlannedCommands] = deque()

    @property
    def records(self) -> tuple[SimulatedMotion, ...]:
        """All motions, in the order of their commands."""
        return tuple(self._records.values())

    @property
    def running(self) -> str:
        """Id of the motion that the controller follows, '' for none."""
        running = self._book.running
        return running[0].id if running else ''

    @property
    def any(self) -> bool:
        """A command has no result yet."""
        return bool(self.commands)

    @property
    def tool(self) -> Pose:
        """Tool of the last command, a pose in tool0."""
        records = self._records
        return records[next(reversed(records))].settings.tool_pose if records else Pose.identity()

    # -- what the program wants -------------------------------------------------------------------

    def command(self, id_: str, command: MotionCommand) -> None:
        """Take a command: it is planned at once, or with the one that it blends into."""
        self.commands[id_] = command
        nan = math.nan
        self._records[id_] = SimulatedMotion(
            id_, command, MotionSettings(), self._now(), nan, nan, False, '', None, (), nan, nan
        )
        try:
            settings = motion_settings(command.settings)
        except RobotsError as error:
            self._end(id_, ok=False, message=error.message, details=error.details)
            return
        self._change(id_, settings=settings)
        order = QueuedCommand(id_, command.kind, _target(command), settings, float(next(self._order)))
        self._plan(self._book.hold(order))

    def flush(self) -> None:
        """No command follows for now."""
        self._plan(self._book.release())

    def abort(self, reason: str) -> None:
        """Give up all motions: the robot stops on its path."""
        for order in self._book.release():
            self._refuse(order, PlanningError('stopped before it began'))
        self._controller.stop(reason)
        self._controller.paused = False

    # -- what the controller does -----------------------------------------------------------------

    def begin(self, now: float) -> None:
        """Hand new plans to the controller."""
        while self._to_controller:
            planned = self._to_controller.popleft()
            id_ = planned.orders[-1].id
            trajectory = _as_in_message(planned.motion.trajectory)
            standing = self._controller.progress == 1.0
            try:
                self._controller.follow(trajectory, id_, now, join_time=planned.join_time)
            except RobotsError as error:
                self.end(MotionResult(id_, ok=False, message=error.message, details=error.details))
                continue
            if standing:
                self._note_start(id_, now)

    def end(self, outcome: MotionResult) -> bool:
        """A motion of the controller has ended; False if it is none of the program's."""
        motion = self._book.ended(outcome.id, ok=outcome.ok, at=float(next(self._order)))
        if motion is None:
            return False
        progress = 1.0 if outcome.ok else float(outcome.details.get('progress', 1.0))
        for id_, passed in motion.passed(progress):
            message = PASSED if passed else outcome.message
            self._end(id_, ok=passed, message=message, details=outcome.details)
        self._end(outcome.id, ok=outcome.ok, message=outcome.message, details=outcome.details)
        if outcome.ok and self.running:
            self._note_start(self.running, self._now())
        return True

    # -- inside -----------------------------------------------------------------------------------

    def _plan(self, orders: tuple[QueuedCommand, ...]) -> None:
        if orders:
            self._planner.plan(orders)

    def _send(self, planned: PlannedCommands) -> None:
        motion = self._book.running[-1]
        starts = (0.0, *motion.ends[:-1])
        for id_, start, end in zip(motion.ids, starts, _ends(motion), strict=True):
            self._change(id_, plan=planned.motion, chain=motion.ids, start_on_plan=start, end_on_plan=end)
        self._on_planned(planned)
        self._to_controller.append(planned)

    def _refuse(self, order: QueuedCommand, error: RobotsError) -> None:
        self._book.refused(order.id)
        self._end(order.id, ok=False, message=error.message, details=error.details)

    def _end(self, id_: str, *, ok: bool, message: str, details: Mapping[str, Any]) -> None:
        command = self.commands.pop(id_, None)
        if command is not None:
            self._change(id_, ended=self._now(), ok=ok, message=message)
            self._on_end(MotionEnd(id_, command, ok, message, details))

    def _note_start(self, id_: str, now: float) -> None:
        for member in self._records[id_].chain:
            self._change(member, started=now)

    def _change(self, id_: str, **changes: Any) -> None:
        self._records[id_] = replace(self._records[id_], **changes)

    def _standing(self) -> Array:
        reference = self._controller.reference
        assert reference is not None
        check_standing(reference[1], self._axes)
        return np.array(reference[0])


def motion_settings(settings: Mapping[str, object]) -> MotionSettings:
    """Modal settings that a program has changed, as planning_node would take them.

    Raises:
        PlanningError: it would refuse them.
    """
    for name, value in settings.items():
        try:
            CHECKS[name](value, name)
        except RobotsError as error:
            raise PlanningError(f'planning_node refuses the settings: {name}: {error}') from error
    wanted: dict[str, Any] = dict(settings)
    return MotionSettings(**wanted)


def _target(command: MotionCommand) -> Target:
    if command.q is not None:
        return command.q
    if command.path:
        return tuple(_through_message(pose) for pose in command.path)
    assert command.pose is not None
    return _through_message(command.pose)


def _through_message(pose: Pose) -> Pose:
    # Quaternions round a little: the planner shall get to the last digit what it gets in a live cell.
    return Pose.from_quaternion(pose.r, pose.quaternion())


def _as_in_message(trajectory: Trajectory) -> Trajectory:
    time = Trajectory.message_times(trajectory.time)
    if np.array_equal(time, trajectory.time):
        return trajectory
    return Trajectory(time, trajectory.position, trajectory.velocity, trajectory.acceleration)


def _ends(motion: RunningMotion) -> tuple[float, ...]:
    return (*motion.ends[:-1], motion.trajectory.duration)
