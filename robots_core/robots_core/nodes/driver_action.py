"""DriverAction: trajectories to a driver as goals of its FollowJointTrajectory."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, Final

from action_msgs.msg import GoalStatus
from rclpy.action.client import ActionClient
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robots_core.cell_interface.driver_file import DriverActionSettings
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import action_type
from robots_core.ros.robot_node import RobotNode

ANSWER_PATIENCE: Final = 2.0  # s, for the answer to a goal
ERRORS: Final = {
    -1: 'invalid goal',
    -2: 'invalid joints',
    -3: 'old time stamp',
    -4: 'path tolerance violated',
    -5: 'goal tolerance violated',
}
TOLERANCES: Final = {-4, -5}


class DriverAction:
    """Sends the newest trajectory in each period; each goal takes the place of the one before.

    All but `put` happens in the executor's thread.

    Args:
        node: Owner.
        settings: Name of the action, and the period.
        failed: Called with the reason, for a person, when the driver refuses a goal, ends it, does not answer
            or is gone; again and again while that holds.

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
        self._node, self._name, self._failed = node, settings.name, failed
        self._client = ActionClient(node, self._action, settings.name)
        node.closing.callback(self._client.destroy)
        self._wanted: JointTrajectory | None = None
        self._sent: JointTrajectory | None = None
        self._number = 0  # of the newest goal
        self._handle: Any = None  # of the newest goal, if it has not ended
        self._asked = math.inf  # s, since when the newest goal has no answer
        self.served = False
        """The driver has served the action."""
        node.create_timer(settings.period, self._check)

    def put(self, trajectory: JointTrajectory | None) -> None:
        """Send this when the next goal is due; None cancels the goal that runs. From any thread."""
        self._wanted = trajectory

    def _check(self) -> None:
        if not self._client.server_is_ready():
            if self.served:
                self._failed(f'{self._name} is not served any more')
            return
        self.served = True
        wanted = self._wanted
        if self._node.now() - self._asked > ANSWER_PATIENCE:
            self._failed(f'{self._name} has not answered for {ANSWER_PATIENCE:g} s')
        if wanted is None:
            self._sent = None
            if self._handle is not None:
                self._handle.cancel_goal_async()
                self._handle = None
            return
        if wanted == self._sent:  # it stands there, or moves there
            return
        self._number += 1
        self._sent, self._asked = wanted, min(self._asked, self._node.now())
        goal = self._action.Goal(trajectory=wanted)
        self._client.send_goal_async(goal).add_done_callback(partial(self._answered, self._number))

    def _answered(self, number: int, future: Future) -> None:
        handle = future.result()
        self._asked = math.inf
        if not handle.accepted:
            self._fail(f'{self._name} has refused a goal')
            return
        if number == self._number:
            self._handle = handle
        handle.get_result_async().add_done_callback(partial(self._ended, number))

    def _ended(self, number: int, future: Future) -> None:
        """A goal has ended; the ends of those that were replaced matter only if a tolerance was violated."""
        response = future.result()
        newest = number == self._number
        if newest:
            canceled, self._handle = self._handle is None, None
            if canceled:
                return
        code = response.result.error_code
        if response.status != GoalStatus.STATUS_SUCCEEDED and (newest or code in TOLERANCES):
            text = f'{ERRORS.get(code, f"code {code}")}: {response.result.error_string}'
            self._fail(f'{self._name} has ended a goal: {text}')

    def _fail(self, reason: str) -> None:
        self._sent, self._handle = None, None
        self._failed(reason)
