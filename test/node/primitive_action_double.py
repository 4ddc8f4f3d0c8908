"""The action of a driver that takes motion primitives, played by a test."""

from __future__ import annotations

from typing import Any

from rclpy.action.server import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future

NAME = '/driver/motion_sequence'


class PrimitiveActionDouble:
    """Accepts sequences, and ends them when the test says so.

    Args:
        node: Where it is served.
        action: Its type.
    """

    def __init__(self, node: Node, action: Any) -> None:
        self.refuses = False
        self.goals: list[Any] = []
        self.canceled = 0
        self._action = action
        self._current = Future()
        self.server = ActionServer(
            node,
            action,
            NAME,
            execute_callback=self._execute,
            goal_callback=lambda _: GoalResponse.REJECT if self.refuses else GoalResponse.ACCEPT,
            cancel_callback=self._cancel,
        )

    @property
    def busy(self) -> bool:
        """A sequence is under way."""
        return bool(self.goals) and not self._current.done()

    def end(self, how: str = 'succeed', code: int = 0, text: str = '') -> None:
        """End the sequence that runs: succeed, abort or canceled."""
        self._current.set_result((how, code, text))

    def _cancel(self, _: Any) -> CancelResponse:
        self.canceled += 1
        self.end('canceled', 0, 'canceled')
        return CancelResponse.ACCEPT

    async def _execute(self, handle: Any) -> Any:
        self._current = own = Future()
        self.goals.append(handle.request.trajectory.motions)
        how, code, text = await own
        getattr(handle, how)()
        return self._action.Result(error_code=code, error_string=text)
