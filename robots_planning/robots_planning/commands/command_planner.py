"""CommandPlanner: plans commanded motions one after the other, each from the end of the one before."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from robots_core.errors import PlanningError, RobotsError
from robots_core.validation import Array
from robots_planning.commands.command_queue import CommandChain, CommandQueue, QueuedCommand, RunningMotion
from robots_planning.commands.motion_chain import ChainPlan, MotionChain, OpenEnd
from robots_planning.commands.motion_results import BLOCKED
from robots_planning.free_paths.free_path_search import SearchCancelledError
from robots_planning.pathplanning import PathPlanning

# A motion that continues from the running one does so this much later, which planning and messages take.
REPLACE_LEAD = 0.15  # s


class CommandPlanner:
    """Called by one thread, in the order of the commands.

    Args:
        planning: Plans.
        queue: Holds what runs.
        standing: Where the robot's reference stands, (n,); raises a PlanningError if it does not.
        path_time: How far the running motion is, s of its plan.
        commit: Takes a plan into the queue, see `CommandQueue.planned`.
        send: Sends a motion.
        refuse: Answers a command that becomes no motion.
        give_up: Answers one that an obstacle has stopped and that does not go on around it.
    """

    def __init__(
        self,
        planning: PathPlanning,
        queue: CommandQueue,
        *,
        standing: Callable[[], Array],
        path_time: Callable[[], float],
        commit: Callable[[RunningMotion, int], bool],
        send: Callable[[ChainPlan], None],
        refuse: Callable[[QueuedCommand, RobotsError], None],
        give_up: Callable[[QueuedCommand, RobotsError], None],
    ) -> None:
        self.replace = False
        """A joint motion takes the place of the running motion, and does not wait for its end."""
        self._planning, self._queue = planning, queue
        self._chain = MotionChain(planning)
        self._open: OpenEnd | None = None
        self._standing, self._path_time, self._commit = standing, path_time, commit
        self._send, self._refuse, self._give_up = send, refuse, give_up

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
                self._give_up(first, reason)
                text = f'given up with motion {first.id} before it: {reason.message}'
                for command in later:
                    self._refuse(command, PlanningError(text))

    def _not_around(self, chain: CommandChain, error: RobotsError) -> RobotsError:
        """Why a motion does not go on around an obstacle."""
        if chain.blocked is None:
            return error
        first, place = chain.commands[0], chain.blocked
        what = self._planning.obstacle_ahead(place.trajectory, place.since)
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
            join_time = planned.motion.duration if planned.open_end is None else planned.open_end.time
            motion = RunningMotion(planned.id, planned.motion.trajectory, planned.ends, join_time)
            if self._commit(motion, failures):
                break
        self._open = planned.open_end
        if planned.join_time > 0.0:
            self._queue.replaced(running[-1])
        self._send(planned)

    def _failed_since(self, failures: int) -> bool:
        return self._queue.failures != failures

    def _planned(self, chain: CommandChain, running: tuple[RunningMotion, ...]) -> ChainPlan:
        commands = chain.commands
        join_time = self._replace_time(running, commands)
        if join_time > 0.0:
            state, only = running[-1].trajectory.sample(join_time), commands[0]
            motion = self._planning.plan_moving(only.kind, state, only.target, only.settings)
            return ChainPlan(commands, motion, {only.id: motion.duration}, join_time=join_time)
        plan, stop = self._carried_on(chain, running)
        if plan is not None:
            join_time = round(running[-1].join_time - running[-1].trajectory.duration, 9)
            return replace(plan, join_time=join_time)
        q = running[-1].trajectory.position[-1] if running else self._standing()
        return replace(self._chain.plan(chain, q), stop=stop)

    def _carried_on(
        self, chain: CommandChain, running: tuple[RunningMotion, ...]
    ) -> tuple[ChainPlan | None, str]:
        """The plan that carries the last motion on; or None, and why its chain stops there."""
        if self._open is None or not running or self._open.commands[-1].id not in running[-1].ends:
            return None, ''
        try:
            plan = None if self._late(running[-1]) else self._chain.continue_from(self._open, chain)
        except RobotsError as error:
            return None, f'it cannot be carried on in motion: {error}'
        if plan is None or self._late(running[-1]):
            return None, 'its next motions came too late to be carried on in motion'
        return plan, ''

    def _late(self, motion: RunningMotion) -> bool:
        """The last motion is too near to its join time, or over."""
        running = self._queue.running
        if len(running) == 1:
            return self._path_time() + REPLACE_LEAD > motion.join_time
        return not running

    def _replace_time(self, running: tuple[RunningMotion, ...], commands: tuple[QueuedCommand, ...]) -> float:
        if not self.replace or len(running) != 1 or len(commands) != 1:
            return 0.0
        if not self._planning.generator(commands[0].kind, commands[0].settings).starts_moving:
            return 0.0
        join_time = round(self._path_time() + REPLACE_LEAD, 9)
        return join_time if join_time < running[0].trajectory.duration else 0.0
