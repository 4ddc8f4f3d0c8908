"""OneGoalServer: an action whose newest goal takes the place of the one that runs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from rclpy.action.server import ActionServer, CancelResponse
from rclpy.task import Future
from std_srvs.srv import Trigger

from robots_core.errors import RobotsError
from robots_core.ros.robot_node import RobotNode
from robots_planning.commands.goal_outcome import CANCELED, PREEMPTED, SUCCESSFUL, Outcome


class Goal:
    """A goal under way."""

    def __init__(self, handle: Any) -> None:
        self.handle = handle
        self.done, self.ended = Future(), Future()
        self.stopped: Outcome | None = None
        """Why it is to end before its motion has."""


AnyGoal = TypeVar('AnyGoal', bound=Goal)


class OneGoalServer(ABC, Generic[AnyGoal]):
    """The action server. A new goal stops the one that runs, and begins where that has stopped.

    Args:
        node: Owner.
        action: Type of the action; its results have `error_code` and `error_string`.
        name: Of the action.
        goal: Makes a goal of a handle of rclpy.
        period: Of feedback, s.
    """

    def __init__(
        self, node: RobotNode, action: Any, name: str, goal: Callable[[Any], AnyGoal], *, period: float
    ) -> None:
        self._node, self._action, self._make = node, action, goal
        self._goal: AnyGoal | None = None
        self._timer = node.create_timer(period, self._poll, autostart=False)
        self._give_up = node.create_client(Trigger, 'controller_node/cancel')
        server = ActionServer(
            node, action, name, execute_callback=self._execute, cancel_callback=self._cancel
        )
        node.closing.callback(server.destroy)

    @abstractmethod
    async def _run(self, goal: AnyGoal) -> Outcome:
        """Do what the goal requests; returns when that has ended.

        Raises:
            RobotsError: the goal is refused.
        """

    @abstractmethod
    def _stop_goal(self, goal: AnyGoal) -> None:
        """Stop the robot on its path, or do not begin; `stopped` of the goal says why."""

    @abstractmethod
    def _poll(self) -> None:
        """Send feedback, and look after the goal; called regularly while it moves the robot."""

    async def _execute(self, handle: Any) -> Any:
        before, goal = self._goal, self._make(handle)
        self._goal = goal
        if before is not None:
            self._end(before, PREEMPTED)
            await before.ended
        try:
            outcome = await self._run(goal)
        except RobotsError as error:
            outcome = Outcome.refused(error)
        finally:
            self._timer.cancel()
            goal.ended.set_result(None)
        if self._goal is goal:
            self._goal = None
        if outcome.canceled:
            handle.canceled()
        elif outcome.code == SUCCESSFUL:
            handle.succeed()
        else:
            handle.abort()
        return self._action.Result(error_code=outcome.code, error_string=outcome.message)

    def _cancel(self, handle: Any) -> CancelResponse:
        goal = self._goal
        if goal is None or goal.handle.goal_id != handle.goal_id:
            return CancelResponse.REJECT
        self._end(goal, CANCELED)
        return CancelResponse.ACCEPT

    def _end(self, goal: AnyGoal, outcome: Outcome) -> None:
        """End a goal before its motion has ended; the first reason counts."""
        if goal.stopped is None:
            goal.stopped = outcome
            self._stop_goal(goal)

    def _stop_motion(self) -> None:
        """Have the controller stop on the path."""
        self._give_up.call_async(Trigger.Request())


def resolve(future: Future, result: Any = None) -> None:
    """Set the result of a future that may have one."""
    if not future.done():
        future.set_result(result)
