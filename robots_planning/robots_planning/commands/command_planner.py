"""CommandPlanner: plans commanded motions one after the other, each from the end of the one before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from robots_core.errors import PlanningError, RobotsError
from robots_core.validation import Array
from robots_planning.commands.command_queue import CommandQueue, QueuedCommand, RunningMotion
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.pathplanning import PathPlanning, PlannedMotion

# A motion that takes the place of the running one does so this much later, which planning and messages take.
REPLACE_LEAD = 0.15  # s


@dataclass(frozen=True, eq=False)
class PlannedCommands:
    """A motion that is ready to be sent.

    Attributes:
        commands: Its commands.
        motion: The plan.
        ends: When each of the commands ends, s of the plan.
        join_time: Path time of the running motion at which this one takes its place, s; 0: after its end.
    """

    commands: tuple[QueuedCommand, ...]
    motion: PlannedMotion
    ends: tuple[float, ...]
    join_time: float = 0.0


class CommandPlanner:
    """Called by one thread, in the order of the commands.

    Args:
        planning: Plans.
        queue: Knows what runs.
        standing: Where the robot's reference stands, (n,); raises a PlanningError if it does not.
        path_time: How far the running motion is, s of its plan.
        send: Sends a motion.
        refuse: Answers a command that becomes no motion.
    """

    def __init__(
        self,
        planning: PathPlanning,
        queue: CommandQueue,
        *,
        standing: Callable[[], Array],
        path_time: Callable[[], float],
        send: Callable[[PlannedCommands], None],
        refuse: Callable[[QueuedCommand, RobotsError], None],
    ) -> None:
        self.replace = False
        """A joint motion takes the place of the running motion, and does not wait for its end."""
        self._planning, self._queue = planning, queue
        self._chain = MotionChain(planning.robot, planning)
        self._standing, self._path_time = standing, path_time
        self._send, self._refuse = send, refuse

    def plan(self, commands: Sequence[QueuedCommand]) -> None:
        """Plan a chain of commands as one motion, or one by one if they do not blend."""
        chain = tuple(commands)
        try:
            self._plan(chain)
        except RobotsError as error:
            if len(chain) == 1:
                self._refuse(chain[0], error)
            else:
                self._plan_each(chain)

    def _plan_each(self, chain: tuple[QueuedCommand, ...]) -> None:
        for place, command in enumerate(chain):
            try:
                self._plan((command,))
            except RobotsError as error:
                self._refuse(command, error)
                for later in chain[place + 1 :]:
                    self._refuse(later, PlanningError(f'given up with motion {command.id} before it'))
                return

    def _plan(self, commands: tuple[QueuedCommand, ...]) -> None:
        while True:
            failures = self._queue.failures
            if reason := self._queue.given_up(commands):
                raise PlanningError(reason)
            running = self._queue.running
            join_time = self._join_time(running, commands)
            if join_time > 0.0:
                q, q_dot, q_ddot = running[-1].trajectory.sample(join_time)
                only = commands[0]
                motion = self._planning.plan_moving(only.kind, (q, q_dot, q_ddot), only.target, only.settings)
                ends: tuple[float, ...] = (motion.duration,)
            else:
                q = running[-1].trajectory.position[-1] if running else self._standing()
                motion, ends = self._chain.plan(commands, q)
            planned = RunningMotion(tuple(command.id for command in commands), motion.trajectory, ends)
            if self._queue.planned(planned, failures):
                break
        if join_time > 0.0:
            self._queue.replaced(running[-1])
        self._send(PlannedCommands(commands, motion, ends, join_time))

    def _join_time(self, running: tuple[RunningMotion, ...], commands: tuple[QueuedCommand, ...]) -> float:
        if not self.replace or len(running) != 1 or len(commands) != 1:
            return 0.0
        if not self._planning.generator(commands[0].kind, commands[0].settings).starts_moving:
            return 0.0
        join_time = round(self._path_time() + REPLACE_LEAD, 9)  # as messages hold it
        return join_time if join_time < running[0].trajectory.duration else 0.0
