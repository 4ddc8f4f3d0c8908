"""The action of a driver's joint_trajectory_controller, after its documentation of Jazzy."""

from __future__ import annotations

from typing import Any

from rclpy.action.server import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future

from robots_core.ros.messages import seconds
from trajectory_controller_double import TrajectoryControllerDouble

NAME = '/driver/follow_joint_trajectory'


class TrajectoryActionDouble:
    """Serves the action over the double of the controller.

    Args:
        node: Where it is served.
        action: Its type.
        controller: Follows the goals.
    """

    def __init__(self, node: Node, action: Any, controller: TrajectoryControllerDouble) -> None:
        self.controller, self.refuses, self.rejected = controller, False, list[str]()
        self.goals = self.canceled = 0
        self._node, self._action = node, action
        self._current: Future | None = None
        self.server = ActionServer(
            node,
            action,
            NAME,
            execute_callback=self._execute,
            goal_callback=lambda _: GoalResponse.REJECT if self.refuses else GoalResponse.ACCEPT,
            cancel_callback=self._cancel,
        )
        node.create_timer(0.01, self._look)
        self._ends_at = 0.0

    def now(self) -> float:
        """Time, s."""
        return self._node.get_clock().now().nanoseconds / 1e9

    def abort(self, code: int, text: str) -> None:
        """End the goal that runs, and stop where the robot is."""
        self.controller.stop(self.now())
        self._end('abort', code, text)

    @property
    def busy(self) -> bool:
        """A goal is under way."""
        return self._current is not None

    def _end(self, *outcome: Any) -> None:
        current, self._current = self._current, None
        if current is not None:
            current.set_result(outcome)

    def _look(self) -> None:
        if self.now() > self._ends_at:
            self._end('succeed', 0, '')

    def _cancel(self, _: Any) -> CancelResponse:
        self.canceled += 1
        self.controller.stop(self.now())
        self._end('canceled', 0, 'canceled')
        return CancelResponse.ACCEPT

    async def _execute(self, handle: Any) -> Any:
        trajectory = handle.request.trajectory
        points = [(seconds(one.time_from_start), one.positions, one.velocities) for one in trajectory.points]
        reason = self.controller.put(self.now(), trajectory.joint_names, points)
        if reason:
            self.rejected.append(reason)
            handle.abort()
            return self._action.Result(error_code=-1, error_string=reason)
        self._end('abort', -1, 'Current goal cancelled due to new incoming action.')
        self.goals += 1
        self._current = own = Future()
        self._ends_at = self.now() + points[-1][0]
        how, code, text = await own
        getattr(handle, how)()
        return self._action.Result(error_code=code, error_string=text)
