"""FollowJointTrajectory: what MoveIt and others send, served where control_msgs is installed."""

import concurrent.futures
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from rclpy.action.server import ActionServer, CancelResponse, GoalResponse
from rclpy.task import Future
from std_srvs.srv import Trigger

from robots_core.errors import InvalidInputError, JointNamesError, RobotsError
from robots_core.motion_result import MotionResult
from robots_core.ros.joint_trajectories import FIELDS, field_rows, point_times
from robots_core.ros.messages import stamp_id
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory
from robots_planning.waypoints import trajectory_through

# The action's error codes.
SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS = 0, -1, -2
PATH_TOLERANCE_VIOLATED, GOAL_TOLERANCE_VIOLATED = -4, -5
ACTION = 'follow_joint_trajectory'


@dataclass(frozen=True, eq=False)
class Outcome:
    """The answer to a goal.

    Attributes:
        code: The action's error code.
        message: For a person.
        canceled: It ended because its client asked for that.
    """

    code: int
    message: str
    canceled: bool = False


def waypoints_trajectory(message: Any, names: list[str], start: Array) -> Trajectory:
    """The motion of a client's trajectory_msgs/JointTrajectory, joints matched by name.

    Raises:
        JointNamesError: a joint is missing or named twice.
        InvalidInputError: no points, points of different kinds, or times that make no motion.
    """
    position, velocity, acceleration = (
        field_rows(message, names, ACTION, field)
        if field == 'positions' or any(len(getattr(point, field)) for point in message.points)
        else None
        for field in FIELDS
    )
    if not message.points:
        raise InvalidInputError(f'{ACTION}: a trajectory needs at least one point, got none')
    assert position is not None
    return trajectory_through(point_times(message), position, velocity, acceleration, start)


class FollowJointTrajectory:
    """The action server. One goal at a time; a new one is refused while another runs.

    Args:
        node: Owner.
        start: Takes a received trajectory and the id of its motion, and sends it to the controller in
            another thread; a RobotsError as its result says why not.
    """

    def __init__(self, node: RobotNode, start: Callable[[Any, str], concurrent.futures.Future[None]]) -> None:
        self._action = import_module('control_msgs.action').FollowJointTrajectory
        self._node, self._start = node, start
        self._motion, self._done = '', Future()
        self._canceled = False
        self._stop = node.create_client(Trigger, 'controller_node/stop')
        self._server = ActionServer(
            node,
            self._action,
            ACTION,
            execute_callback=self._execute,
            goal_callback=lambda _: GoalResponse.REJECT if self._motion else GoalResponse.ACCEPT,
            cancel_callback=self._cancel,
        )

    async def _execute(self, goal: Any) -> Any:
        # The id is known before the motion is: its result may come at once.
        self._motion = stamp_id(self._node.get_clock().now().to_msg())
        self._done, self._canceled = Future(), False
        started = Future()
        self._start(goal.request.trajectory, self._motion).add_done_callback(
            lambda sent: started.set_result(sent.exception())
        )
        error = await started
        if error is None:
            outcome = outcome_of(await self._done, canceled=self._canceled)
        elif isinstance(error, RobotsError):
            outcome = refusal_of(error)
        else:
            raise error
        self._motion = ''
        return self._answer(goal, outcome)

    def _answer(self, goal: Any, outcome: Outcome) -> Any:
        if outcome.code == SUCCESSFUL:
            goal.succeed()
        elif outcome.canceled:
            goal.canceled()
        else:
            goal.abort()
        return self._action.Result(error_code=outcome.code, error_string=outcome.message)

    def _cancel(self, _: object) -> CancelResponse:
        self._canceled = True
        self._stop.call_async(Trigger.Request())
        return CancelResponse.ACCEPT

    def ended(self, result: MotionResult) -> None:
        """A motion has ended; if it is the goal's, the goal has."""
        if self._motion and result.id == self._motion:
            self._done.set_result(result)

    def destroy(self) -> None:
        """End the server with its node."""
        self._server.destroy()


def refusal_of(error: RobotsError) -> Outcome:
    """Why a goal is not begun, as an answer to it."""
    return Outcome(INVALID_JOINTS if isinstance(error, JointNamesError) else INVALID_GOAL, error.message)


def outcome_of(result: MotionResult, *, canceled: bool) -> Outcome:
    """A motion's result as an answer to a goal."""
    if result.ok:
        return Outcome(SUCCESSFUL, result.message)
    at_target = float(result.details.get('progress', 0.0)) >= 1.0
    code = GOAL_TOLERANCE_VIOLATED if at_target else PATH_TOLERANCE_VIOLATED
    return Outcome(code, result.message, canceled=canceled)
