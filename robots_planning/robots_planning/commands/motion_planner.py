"""MotionPlanner: motion commands in, verified trajectories to the controller and results out."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final, Protocol

import numpy as np

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.commands.command_planner import REPLACE_LEAD, CommandPlanner
from robots_planning.commands.command_queue import CommandChain, CommandQueue, QueuedCommand, RunningMotion
from robots_planning.commands.motion_chain import ChainPlan
from robots_planning.commands.motion_results import BLOCKED, PASSED
from robots_planning.motion_kinds import LINE, MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning, PlannedMotion
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.trajectory_generator import Target

# A blended motion waits so long for the one that it runs through to; then it stops at its end. A program that
# changes settings in between needs two questions and answers of busy processes for it.
BLEND_PATIENCE: Final = 0.3  # s
HELD_UP: Final = 'the planner was held up'
REST_SPEED: Final = 1e-5  # rad/s (m/s); a reference this slow is rounding of one that stands


class MotionPlannerPort(Protocol):
    """What a transport provides to the planner."""

    def time(self) -> float:
        """Time, s, on the clock by which the controller stamps its results."""

    def reference(self) -> tuple[Array, Array] | None:
        """The controller's reference, position and velocity (n,) each; None before the first.

        Raises:
            RobotsError: the reference is not valid.
        """

    def controllers(self) -> frozenset[bytes]:
        """Identities of the controllers, for a while also of a killed one; a new process has another."""
        return frozenset()

    def missed(self) -> bool:
        """Whether the process was held up for so long that the others have given up what they had commanded.

        True until its next sign of life.
        """
        return False

    def submit(self, work: Callable[[], None]) -> None:
        """Do work that takes long: now, or in the planner's thread, one after the other."""

    def release_after(self, patience: float) -> None:  # noqa: ARG002
        """Call `end_wait` after this time, s, counted from the last call of this."""
        return

    def send(
        self, id_: str, motion: PlannedMotion, ends: Mapping[str, float], *, title: str, join_time: float
    ) -> None:
        """Send a motion to the controller.

        Args:
            id_: Its own: that of its last command before the next motion may carry it on.
            motion: The plan.
            ends: When each of its commands ends, s of the plan, by id and in order.
            title: Its kinds, and why its chain stops before it, for a person.
            join_time: Path time of the running motion at which it takes its place, s. Below 0 it carries the
                last motion on, so long before that one's end; 0: after its end.
        """

    def answer(self, result: MotionResult) -> None:
        """Send the result of a command that ends without a motion of its own."""

    def refused(self, topic: str, error: RobotsError) -> None:  # noqa: ARG002
        """Report a command that was refused."""
        return

    def finished(self, *, done: bool) -> None:
        """All motions have reached their targets, or one was sent."""


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
        self._commands = CommandPlanner(
            planning,
            self._queue,
            standing=self.standing,
            path_time=self._path_time,
            commit=self._commit,
            send=self._send,
            refuse=self._refuse,
            give_up=self._fail,
        )
        self.settings = MotionSettings()
        """Hold for the commands that come from now on."""
        self.reference_pose: Pose | None = None
        """Where a trigger leads."""
        self._triggered = False
        self._unplanned: deque[CommandChain] = deque()  # on their way to the thread that plans, or there
        self._planning_time = 0.0  # s, that the last plan took
        self._progress = (0.0, 0.0)  # of the running motion, and when it was reported
        self._controllers: frozenset[bytes] = frozenset()  # when the last motion was sent

    @property
    def moving(self) -> bool:
        """A motion was sent to the controller and has not ended."""
        return bool(self.motions)

    @property
    def motions(self) -> tuple[RunningMotion, ...]:
        """Motions that were sent and have not ended, oldest first: the controller follows the first."""
        return self._queue.running

    def holds(self, id_: str) -> bool:
        """A command with this id has come and has not ended."""
        return self._queue.holds(id_)

    # -- commands -------------------------------------------------------------------------------------

    def command(self, id_: str, kind: MotionKind, target: Target, settings: MotionSettings) -> bool:
        """Take a motion command.

        Args:
            id_: Unique.
            kind: The kind of motion.
            target: See `PathPlanning.plan`.
            settings: The modal settings of that instant.

        Returns:
            False for a command that came before; it is ignored.
        """
        if self.moving and self._controllers and self._controllers.isdisjoint(self._port.controllers()):
            self._queue.forget()  # the controller is gone, and its motions with it
        if self.holds(id_):
            return False
        if not self._queue.chains(settings):
            self.release()
        self._plan(self._queue.hold(QueuedCommand(id_, kind, target, settings, self._port.time())))
        if settings.blends:
            self._port.release_after(BLEND_PATIENCE)
        return True

    def refuse(self, id_: str, kind: MotionKind, error: RobotsError) -> None:
        """End a command that is not valid."""
        self._port.refused(kind.topic, error)
        self._port.answer(MotionResult.refused(id_, error))

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
        stops = bool(running) and running[-1].join_time == running[-1].trajectory.duration
        # Before a stop nothing is lost by waiting: a program sends more when its motions end.
        if self._unplanned or stops:
            return BLEND_PATIENCE
        if not running:
            return 0.0
        done = self._path_time() if len(running) == 1 else 0.0
        return running[-1].join_time - done - REPLACE_LEAD - BLEND_PATIENCE - self._planning_time

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
        running = RunningMotion(id_, motion.trajectory, {id_: motion.duration}, motion.duration)
        if not self._commit(running, failures):
            raise PlanningError('it was given up while it was being planned; command it again')
        self._follow(id_, motion, running.ends, 'a given trajectory', 0.0)

    # -- the controller -------------------------------------------------------------------------------

    def progress(self, progress: float) -> None:
        """The controller has done this part of the running motion, 0..1."""
        self._progress = (progress, self._port.time())

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
        self._progress = (0.0, self._port.time())  # of the one after it
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
        self._progress = (0.0, self._port.time())
        for id_ in passed:
            self._port.answer(MotionResult(id_, ok=True, message=PASSED, details=result.details))
        self._port.submit(self._commands.go_around)
        return True

    def _end_blocked(
        self, motion: RunningMotion, result: MotionResult, progress: float, replans: int
    ) -> None:
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

    def standing(self) -> Array:
        """Where the controller's reference stands, (n,).

        Raises:
            PlanningError: no reference came yet, or the robot moves; names the fastest axis.
        """
        reference = self._port.reference()
        if reference is None:
            raise PlanningError(
                'no joint_reference received: is controller_node running and does the robot publish '
                'joint_states?'
            )
        (q, q_dot), axes = reference, self.planning.robot.axes_data
        fastest = int(np.argmax(np.abs(q_dot)))
        if abs(q_dot[fastest]) > REST_SPEED:
            raise PlanningError(
                f'the robot is still moving: the reference of {axes.names[fastest]} has '
                f'{q_dot[fastest]:.4g} {axes.unit(fastest)}/s; wait until it stands'
            )
        return q

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

    def _commit(self, motion: RunningMotion, failures: int) -> bool:
        """Take a plan into the queue, see `CommandQueue.planned`, unless the process was held up just now."""
        if self._port.missed():
            self._queue.give_up(HELD_UP, self._port.time())
        return self._queue.planned(motion, failures)

    def _send(self, planned: ChainPlan) -> None:
        title = ' + '.join(command.kind.title for command in planned.commands)
        if planned.stop:
            title += f' after a stop of its chain ({planned.stop})'
        self._follow(planned.id, planned.motion, planned.ends, title, planned.join_time)

    def _follow(
        self, id_: str, motion: PlannedMotion, ends: Mapping[str, float], title: str, join_time: float
    ) -> None:
        if len(self.motions) == 1:
            self._progress = (0.0, self._port.time())
        self._port.finished(done=False)
        self._port.send(id_, motion, ends, title=title, join_time=join_time)
        self._controllers = self._port.controllers()

    def _refuse(self, command: QueuedCommand, error: RobotsError) -> None:
        self._queue.refused(command.id)
        self.refuse(command.id, command.kind, error)

    def _fail(self, command: QueuedCommand, error: RobotsError) -> None:
        self._queue.fail(command.id, self._port.time())
        self._refuse(command, error)

    def _path_time(self) -> float:
        progress, reported = self._progress
        running = self.motions
        if not running:
            return 0.0
        # No override makes it faster than planned.
        return progress * running[0].trajectory.duration + max(0.0, self._port.time() - reported)
