"""CommandPlanner: plans commanded motions one after the other, each from the end of the one before."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Final, Protocol

import numpy as np

from robots_core.cell_interface.motion_result import BLOCKED, MotionResult
from robots_core.errors import PlanningError, RobotsError
from robots_core.validation import Array
from robots_planning.commands.command_queue import CommandQueue
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, MotionPlan, QueuedCommand
from robots_planning.free_paths.errors import SearchCancelledError
from robots_planning.motion_kinds import MotionKind
from robots_planning.pathplanning import PathPlanning

HELD_UP: Final = 'the planner was held up'
REST_SPEED: Final = 1e-5  # rad/s (m/s); a reference this slow is rounding of one that stands
# A motion that continues from the running one does so this much later, which planning and messages take.
REPLACE_LEAD = 0.15  # s


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

    def send(self, plan: MotionPlan) -> None:
        """Send a plan to the controller."""

    def answer(self, result: MotionResult) -> None:
        """Send the result of a command that ends without a motion of its own."""

    def refused(self, topic: str, error: RobotsError) -> None:  # noqa: ARG002
        """Report a command that was refused."""
        return

    def finished(self, *, done: bool) -> None:
        """All motions have reached their targets, or one was sent."""


class CommandPlanner:
    """Called by one thread, in the order of the commands.

    Args:
        planning: Plans.
        queue: Holds what runs.
        port: The transport.
    """

    def __init__(self, planning: PathPlanning, queue: CommandQueue, port: MotionPlannerPort) -> None:
        self.replace = False
        """A joint motion takes the place of the running motion, and does not wait for its end."""
        self._planning, self._queue, self._port = planning, queue, port
        self._chain = MotionChain(planning)
        self._progress = (0.0, 0.0)  # of the running motion, and when it was reported
        self._controllers: frozenset[bytes] = frozenset()  # when the last motion was sent

    def plan(self, chain: CommandChain) -> None:
        """Plan a chain of commands as one motion, or one by one if they do not blend."""
        self.go_around()
        try:
            self._plan(chain)
        except RobotsError as error:
            if len(chain.commands) == 1:
                self._refuse(chain.commands[0], error)
            else:
                self._plan_each(chain.commands)

    def go_around(self, before: CommandChain | None = None) -> None:
        """Plan what an obstacle has stopped from where the robot stands, if it is older than a chain."""
        while (chain := self._queue.around(before)) is not None:
            first, *later = chain.commands
            try:
                self._plan(chain)
            except RobotsError as error:
                reason = self._not_around(chain, error)
                self._queue.fail(first.id, self._port.time())
                self._refuse(first, reason)
                text = f'given up with motion {first.id} before it: {reason.message}'
                for command in later:
                    self._refuse(command, PlanningError(text))

    def _not_around(self, chain: CommandChain, error: RobotsError) -> RobotsError:
        """Why a motion does not go on around an obstacle."""
        if chain.blocked is None:
            return error
        first, what = chain.commands[0], self._planning.obstacle_ahead(*chain.blocked)
        attempt = f'attempt {first.replans} of {first.settings.most_replans} to go around it'
        return PlanningError(f'{BLOCKED}: {what}; {attempt} failed: {error.message}', **error.details)

    def _plan_each(self, commands: tuple[QueuedCommand, ...]) -> None:
        for place, command in enumerate(commands):
            try:
                self._plan(CommandChain((command,)))
            except RobotsError as error:
                self._refuse(command, error)
                for later in commands[place + 1 :]:
                    self._refuse(later, PlanningError(f'given up with motion {command.id} before it'))
                return

    def _plan(self, chain: CommandChain) -> None:
        while True:
            self.go_around(before=chain)
            failures = self._queue.failures
            # Only a motion that fails gives up those after it; see `CommandQueue`.
            self._planning.cancelled = partial(self._failed_since, failures)
            if reason := self._queue.given_up(chain.commands):
                raise PlanningError(reason)
            running = self._queue.running
            try:
                planned = self._planned(chain, running)
            except SearchCancelledError:
                continue
            if self.commit(planned, failures):
                break
        if planned.join_time > 0.0:
            self._queue.replaced(running[-1])
        self.send(planned)

    def _failed_since(self, failures: int) -> bool:
        return self._queue.failures != failures

    def _planned(self, chain: CommandChain, running: tuple[MotionPlan, ...]) -> MotionPlan:
        commands = chain.commands
        join_time = self._replace_time(running, commands)
        if join_time > 0.0:
            state, only = running[-1].trajectory.sample(join_time), commands[0]
            motion = self._planning.plan_moving(only.kind, state, only.target, only.settings)
            ends = {only.id: motion.duration}
            return MotionPlan(only.id, motion, ends, only.kind.title, join_time=join_time)
        plan, stop = self._carried_on(chain, running)
        if plan is not None:
            join_time = round(running[-1].open_time - running[-1].trajectory.duration, 9)
            return replace(plan, join_time=join_time)
        q = running[-1].trajectory.position[-1] if running else self.standing()
        plan = self._chain.plan(chain, q)
        return replace(plan, title=f'{plan.title} after a stop of its chain ({stop})') if stop else plan

    def _carried_on(
        self, chain: CommandChain, running: tuple[MotionPlan, ...]
    ) -> tuple[MotionPlan | None, str]:
        """The plan that carries the last motion on; or None, and why its chain stops there."""
        if not running or running[-1].open_end is None:
            return None, ''
        try:
            plan = None if self._late(running[-1]) else self._chain.continue_from(running[-1].open_end, chain)
        except RobotsError as error:
            return None, f'it cannot be carried on in motion: {error}'
        if plan is None or self._late(running[-1]):
            return None, 'its next motions came too late to be carried on in motion'
        return plan, ''

    def _late(self, motion: MotionPlan) -> bool:
        """The last motion is too near to its join time, or over."""
        running = self._queue.running
        if len(running) == 1:
            return self.path_time() + REPLACE_LEAD > motion.open_time
        return not running

    def _replace_time(self, running: tuple[MotionPlan, ...], commands: tuple[QueuedCommand, ...]) -> float:
        if not self.replace or len(running) != 1 or len(commands) != 1:
            return 0.0
        if not self._planning.generator(commands[0].kind, commands[0].settings).starts_moving:
            return 0.0
        join_time = round(self.path_time() + REPLACE_LEAD, 9)
        return join_time if join_time < running[0].trajectory.duration else 0.0

    # -- the controller and those who wait for results -------------------------------------------------

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
        (q, q_dot), axes = reference, self._planning.robot.axes_data
        fastest = int(np.argmax(np.abs(q_dot)))
        if abs(q_dot[fastest]) > REST_SPEED:
            raise PlanningError(
                f'the robot is still moving: the reference of {axes.names[fastest]} has '
                f'{q_dot[fastest]:.4g} {axes.unit(fastest)}/s; wait until it stands'
            )
        return q

    def progress(self, progress: float) -> None:
        """The controller has done this part of the running motion, 0..1."""
        self._progress = (progress, self._port.time())

    def path_time(self) -> float:
        """How far the running motion is, s of its plan."""
        progress, reported = self._progress
        running = self._queue.running
        if not running:
            return 0.0
        # No override makes it faster than planned.
        return progress * running[0].trajectory.duration + max(0.0, self._port.time() - reported)

    @property
    def controller_gone(self) -> bool:
        """The controller that the last motion was sent to is gone."""
        return bool(self._controllers) and self._controllers.isdisjoint(self._port.controllers())

    def commit(self, plan: MotionPlan, failures: int) -> bool:
        """Take a plan into the queue, see `CommandQueue.planned`, unless the process was held up just now."""
        if self._port.missed():
            self._queue.give_up(HELD_UP, self._port.time())
        return self._queue.planned(plan, failures)

    def send(self, plan: MotionPlan) -> None:
        """Send a plan that was committed."""
        if len(self._queue.running) == 1:
            self.progress(0.0)
        self._port.finished(done=False)
        self._port.send(plan)
        self._controllers = self._port.controllers()

    def refuse(self, id_: str, kind: MotionKind, error: RobotsError) -> None:
        """End a command that is not valid."""
        self._port.refused(kind.topic, error)
        self._port.answer(MotionResult.refused(id_, error))

    def _refuse(self, command: QueuedCommand, error: RobotsError) -> None:
        """Answer a command that becomes no motion."""
        self._queue.refused(command.id)
        self.refuse(command.id, command.kind, error)
