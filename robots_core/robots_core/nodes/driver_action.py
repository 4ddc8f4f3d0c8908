"""DriverAction: the goals of `DriverGoals` as messages of FollowJointTrajectory."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from action_msgs.msg import GoalStatus
from rclpy.action.client import ActionClient
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.drives.driver_goals import DriverGoals
from robots_core.cell_interface.driver_file import DriverActionSettings
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import action_type
from robots_core.ros.robot_node import RobotNode


class DriverAction:
    """Sends the newest trajectory in each period.

    All but `put` happens in the executor's thread.

    Args:
        node: Owner.
        settings: Name of the action, and the period.
        failed: See `DriverGoals`.

    Raises:
        InvalidInputError: control_msgs is not installed.
    """

    def __init__(
        self, node: RobotNode, settings: DriverActionSettings, failed: Callable[[str], None]
    ) -> None:
        self._action = action_type('FollowJointTrajectory')
        if self._action is None:
            raise InvalidInputError(
                f'action {settings.name} needs control_msgs, which is not installed; install it with ROS, or '
                'name the topic of the driver by `trajectory`'
            )
        self._node = node
        self._client = ActionClient(node, self._action, settings.name)
        node.closing.callback(self._client.destroy)
        self._wanted: JointTrajectory | None = None
        self._goals = DriverGoals(settings.name, failed)
        self._handle: Any = None  # of the newest goal that was accepted
        node.create_timer(settings.period, self._check)

    @property
    def served(self) -> bool:
        """The driver has served the action."""
        return self._goals.served

    def put(self, trajectory: JointTrajectory | None) -> None:
        """Send this when the next goal is due; None cancels the goal that runs. From any thread."""
        self._wanted = trajectory

    def _check(self) -> None:
        wanted, served = self._wanted, self._client.server_is_ready()
        due = self._goals.due(wanted, self._node.now(), served=served)
        if due == 'cancel':
            self._handle.cancel_goal_async()
        elif due == 'send':
            future = self._client.send_goal_async(self._action.Goal(trajectory=wanted))
            future.add_done_callback(partial(self._answered, self._goals.number))

    def _answered(self, number: int, future: Future) -> None:
        handle = future.result()
        self._goals.answered(number, accepted=handle.accepted)
        if handle.accepted:
            if number == self._goals.number:
                self._handle = handle
            handle.get_result_async().add_done_callback(partial(self._ended, number))

    def _ended(self, number: int, future: Future) -> None:
        response = future.result()
        succeeded, result = response.status == GoalStatus.STATUS_SUCCEEDED, response.result
        self._goals.ended(number, succeeded=succeeded, code=result.error_code, text=result.error_string)
