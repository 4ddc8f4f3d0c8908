"""MotionPlanner: motion commands in, verified trajectories to the controller and results out."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Final

from robots_core.cell_interface.motion_result import BLOCKED, PASSED, MotionResult
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.commands.command_planner import (
    HELD_UP,
    REPLACE_LEAD,
    CommandPlanner,
    MotionPlannerPort,
)
from robots_planning.commands.command_queue import CommandQueue
from robots_planning.commands.motion_plan import CommandChain, MotionPlan, QueuedCommand
from robots_planning.motion_kinds import LINE, MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.trajectory_generator import Target

# A blended motion waits so long for the one that it runs through to; then it stops at its end. A program that
# changes settings in between needs two questions and answers of busy processes for it.
BLEND_PATIENCE: Final = 0.3  # s


class MotionPlanner:
    """Plans commands in their order; one that comes while the robot moves follows the motions before it.

    A command that cannot be planned ends with a result that gives the reason; the controller reports the
    result of a planned motion. Called by one thread, except for the work that it submits. See the paper's
    section 3 for `trigger`.

    Args:
        planning: Plans.
        port: The transport.
    """

    def __init__(self, planning: PathPlanning, port: MotionPlannerPort) -> None:
        self.planning, self._port = planning, port
        self._queue = CommandQueue()
        self._commands = CommandPlanner(planning, self._queue, port)
        self.standing = self._commands.standing
        """See `CommandPlanner.standing`."""
        self.refuse = self._commands.refuse
        """See `CommandPlanner.refuse`."""
        self.settings = MotionSettings()
        """Hold for the commands that come from now on."""
        self.reference_pose: Pose | None = None
        """Where a trigger leads."""
        self._triggered = False
        self._unplanned: deque[CommandChain] = deque()  # on their way to the thread that plans, or there
        self._planning_time = 0.0  # s, that the last plan took

    @property
    def moving(self) -> bool:
        """A motion was sent to the controller and has not ended."""
        return bool(self.motions)

    @property
    def motions(self) -> tuple[MotionPlan, ...]:
        """Motions that were sent and have not ended, oldest first: the controller follows the first."""
        return self._queue.running

    def holds(self, id_: str) -> bool:
        """A command with this id has come and has not ended."""
        return self._queue.holds(id_)

    # -- commands -------------------------------------------------------------------------------------

    def command(self, id_: str, kind: MotionKind, target: Target, settings: MotionSettings) -> bool:
        """Take a motion command, see `QueuedCommand`; False for one that came before, which is ignored."""
        if self.moving and self._commands.controller_gone:
            self._queue.forget()  # the controller is gone, and its motions with it
        if self.holds(id_):
            return False
        if not self._queue.chains(settings):
            self.release()
        self._plan(self._queue.hold(QueuedCommand(id_, kind, target, settings, self._port.time())))
        if settings.blends:
            self._port.release_after(BLEND_PATIENCE)
        return True

    def configure(self, settings: MotionSettings) -> None:
        """Change the settings of the commands that follow.

        Where they switch blending off, nothing comes that the commands held for a chain could run through to.
        """
        self.settings = settings
        if not settings.blends:
            self.release()

    def release(self) -> None:
        """Plan the commands that wait for another one to blend into: none follows."""
        self._plan(self._queue.release())

    def end_wait(self) -> None:
        """Plan the commands that wait for another one, unless the robot has motions until later."""
        time = self._time_left()
        if time > 0.0:
            self._port.release_after(time)
        else:
            self.release()

    def _time_left(self) -> float:
        """How long commands may wait until the motion before them can only just be carried on, s."""
        running = self.motions
        stops = bool(running) and running[-1].open_end is None
        # Before a stop nothing is lost by waiting: a program sends more when its motions end.
        if self._unplanned or stops:
            return BLEND_PATIENCE
        if not running:
            return 0.0
        done = self._commands.path_time() if len(running) == 1 else 0.0
        return running[-1].open_time - done - REPLACE_LEAD - BLEND_PATIENCE - self._planning_time

    def replace_motions(self, *, replace: bool) -> None:
        """Let joint motions replace the running motion, or follow it."""
        self._commands.replace = replace

    def trigger(self, id_: str, *, level: bool) -> None:
        """On a rising edge, move on a line to the last `reference_pose`."""
        rising, self._triggered = level and not self._triggered, level
        if not rising:
            return
        if self.reference_pose is None:
            error = PlanningError('trigger came without a valid reference_pose before it')
            self.refuse(id_, LINE, error)
        else:
            self.command(id_, LINE, self.reference_pose, self.settings)

    def send_given(self, id_: str, trajectory: Callable[[Array], Trajectory]) -> None:
        """Send a trajectory that was planned elsewhere; it is made from where the robot stands, (n,).

        Raises:
            RobotsError: it breaks a limit, collides, or starts elsewhere; or the robot moves.
        """
        if self.moving:
            raise PlanningError('the robot is still moving; wait for its motion_result or stop it')
        failures = self._queue.failures
        motion = self.planning.checked(trajectory(self.standing()), settings=self.settings)
        plan = MotionPlan(id_, motion, {id_: motion.duration}, 'a given trajectory')
        if not self._commands.commit(plan, failures):
            raise PlanningError('it was given up while it was being planned; command it again')
        self._commands.send(plan)

    # -- the controller -------------------------------------------------------------------------------

    def progress(self, progress: float) -> None:
        """The controller has done this part of the running motion, 0..1."""
        self._commands.progress(progress)

    def result(self, result: MotionResult, ended: float) -> bool:
        """A motion of the controller has ended.

        Args:
            result: Its result.
            ended: When, s; what was commanded before is void if it did not reach its target.

        Returns:
            False if it is none of this planner's.
        """
        if not result.ok and self._queue.stale(result.id):
            return True
        progress = 1.0 if result.ok else float(result.details.get('progress', 1.0))
        if result.blocked and self._goes_around(result, progress):
            return True
        replans = self._queue.replans(result.id, progress)
        motion = self._queue.ended(result.id, ok=result.ok, at=ended)
        if motion is None:
            return False
        self._commands.progress(0.0)  # of the one after it
        for id_, passed in motion.passed(progress):
            message = PASSED if passed else result.message
            self._port.answer(MotionResult(id_, passed, message, result.details, code=result.code))
        if result.ok and not self.moving:
            self._port.finished(done=True)
        if result.blocked:
            self._port.submit(partial(self._end_blocked, motion, result, progress, replans))
        if not result.ok:
            self.release()  # what was held for a chain is void
        return True

    def _goes_around(self, result: MotionResult, progress: float) -> bool:
        """Whether a motion that an obstacle has stopped is planned around it."""
        passed = self._queue.blocked(result.id, progress)
        if passed is None:
            return False
        self._commands.progress(0.0)
        for id_ in passed:
            self._port.answer(MotionResult(id_, ok=True, message=PASSED, details=result.details))
        self._port.submit(self._commands.go_around)
        return True

    def _end_blocked(self, motion: MotionPlan, result: MotionResult, progress: float, replans: int) -> None:
        """Report the obstacles of a motion that does not go around it."""
        trajectory = motion.trajectory
        what = self.planning.obstacle_ahead(trajectory, progress * trajectory.duration)
        again = ''
        if replans:
            paths = 'path' if replans == 1 else 'paths'
            again = f' again, after {replans} replanned {paths}, as many as most_replans allows'
        message = f'{BLOCKED}{again}: {what}'
        self._port.answer(MotionResult(result.id, ok=False, message=message, details=result.details))

    def held_up(self) -> None:
        """Send nothing of what was commanded before the process was held up; from any thread.

        Called before its next sign of life; `release` follows.
        """
        self._queue.give_up(HELD_UP, self._port.time())

    def lose_controller(self, reason: str) -> None:
        """The controller ends no motion any more: end them in its place."""
        for motion in self.motions:
            self._port.answer(MotionResult(motion.id, ok=False, message=reason))
        if not self.motions:
            self._queue.give_up(reason, self._port.time())

    def give_up(self, reason: str, until: float | None = None) -> None:
        """Send nothing of what was commanded until now; a motion that runs ends with its stop.

        Args:
            reason: Why, for a person.
            until: Send nothing of what was commanded before this time, s, instead.
        """
        self._queue.give_up(reason, self._port.time() if until is None else until)
        self.release()

    # -- inside ---------------------------------------------------------------------------------------

    def _plan(self, chain: CommandChain | None) -> None:
        if chain is not None:
            self._unplanned.append(chain)
            self._port.submit(self._plan_next)

    def _plan_next(self) -> None:
        begin = self._port.time()
        try:
            self._commands.plan(self._unplanned[0])
        finally:
            self._planning_time = self._port.time() - begin
            self._unplanned.popleft()
