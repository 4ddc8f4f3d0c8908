"""FollowJointTrajectory: what MoveIt and others send, served where control_msgs is installed."""

import concurrent.futures
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.task import Future
from sensor_msgs.msg import JointState

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, JointNamesError, RobotsError
from robots_core.ros.joint_trajectories import FIELDS, field_rows, point_times
from robots_core.ros.messages import doubles, joint_indices, joint_motion, seconds, stamp_id
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.validation import Array
from robots_planning.goal_tolerances import GoalTolerances, Tolerance
from robots_planning.nodes.one_goal_server import (
    INVALID_GOAL,
    SUCCESSFUL,
    Goal,
    OneGoalServer,
    Outcome,
    resolve,
)
from robots_planning.trajectory import Trajectory
from robots_planning.waypoints import positions_from_velocities, trajectory_through

# The action's own error codes.
INVALID_JOINTS = -2
PATH_TOLERANCE_VIOLATED, GOAL_TOLERANCE_VIOLATED = -4, -5
ACTION = 'follow_joint_trajectory'
FEEDBACK_PERIOD = 0.02  # s
AT_TARGET = 1e-9  # rad (m), of references, which end there but for rounding
UNLIMITED = -1.0  # of a tolerance, as in control_msgs


def waypoints_trajectory(message: Any, names: list[str], start: Array, late: float = 0.0) -> Trajectory:
    """The motion of a client's trajectory_msgs/JointTrajectory, joints matched by name.

    Args:
        message: The trajectory.
        names: Joints of the robot.
        start: Where it stands, (n,).
        late: How long ago the trajectory should have begun, s: points before are left out.

    Raises:
        JointNamesError: a joint is missing or named twice.
        InvalidInputError: no points, points of different kinds, or times that make no motion.
    """
    joint_indices(message.joint_names, names, ACTION)
    time = point_times(message)
    given = [any(len(getattr(point, field)) for point in message.points) for field in FIELDS]
    rows = [
        field_rows(message, names, ACTION, field) if has else None
        for field, has in zip(FIELDS, given, strict=True)
    ]
    if not message.points:
        raise InvalidInputError(f'{ACTION}: a trajectory needs at least one point, got none')
    if late > 0.0:
        if time[-1] <= late:
            raise InvalidInputError(f'{ACTION}: the trajectory has ended {late - time[-1]:.6g} s ago')
        ahead = time > late
        time, rows = time[ahead] - late, [None if row is None else row[ahead] for row in rows]
    position, velocity, acceleration = rows
    if position is None:
        if velocity is None:
            raise InvalidInputError(f'{ACTION}: points have neither positions nor velocities')
        position = positions_from_velocities(time, velocity, start)
    return trajectory_through(time, position, velocity, acceleration, start)


class TrajectoryGoal(Goal):
    """A goal under way; see `Goal`."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self.motion = ''
        """Id of its motion; '' before it has begun."""
        self.tolerances: GoalTolerances | None = None
        self.due = Future()
        self.target: Array | None = None
        self.at_end = math.inf  # s, since when the reference stands at the target


class FollowJointTrajectory(OneGoalServer[TrajectoryGoal]):
    """The action server; see `OneGoalServer`.

    Args:
        node: Owner.
        action: Its type.
        start: Takes what makes a trajectory from where the robot stands, and the id of its motion, and sends
            it to the controller in another thread; a RobotsError as its result says why not.
        reference: The newest reference, positions and velocities, (n,) each; None before the first.
    """

    def __init__(
        self,
        node: RobotNode,
        action: Any,
        start: Callable[[Callable[[Array], Trajectory], str], concurrent.futures.Future[None]],
        reference: Callable[[], tuple[Array, Array] | None],
    ) -> None:
        self._start, self._reference = start, reference
        self._names = list(node.robot.axes_data.names)
        self._moving: dict[
            str, TrajectoryGoal
        ] = {}  # by the id of the motion; a goal that is preempted still brakes
        self._states = PolledSubscription(node, JointState, 'joint_states')
        self._actual: tuple[Array, Array] | None = None
        self._timer = node.create_timer(FEEDBACK_PERIOD, self._poll, autostart=False)
        super().__init__(node, action, ACTION, TrajectoryGoal)

    async def _run(self, goal: TrajectoryGoal) -> Outcome:
        message, now = goal.handle.request.trajectory, self._node.get_clock().now().nanoseconds * 1e-9
        stamp = seconds(message.header.stamp)
        goal.tolerances = tolerances_of(goal.handle.request, self._names)
        if stamp > now:
            timer = self._node.create_timer(stamp - now, lambda: resolve(goal.due))
            await goal.due
            self._node.destroy_timer(timer)
        if goal.stopped is not None:
            return goal.stopped
        late = max(0.0, now - stamp) if stamp else 0.0
        # The id is known before the motion is: its result may come at once.
        goal.motion = stamp_id(self._node.get_clock().now().to_msg())
        self._moving[goal.motion] = goal
        started = Future()

        def make(q: Array) -> Trajectory:
            trajectory = waypoints_trajectory(message, self._names, q, late)
            goal.target = trajectory.position[-1]
            return trajectory

        self._start(make, goal.motion).add_done_callback(lambda sent: started.set_result(sent.exception()))
        error = await started
        if error is not None:
            raise error
        if goal.stopped is not None:  # before there was a motion to stop
            self._stop_motion()
        self._timer.reset()
        result = await goal.done
        self._take_states()
        return goal.stopped or self._outcome(goal, result)

    def _outcome(self, goal: TrajectoryGoal, result: MotionResult) -> Outcome:
        outcome = outcome_of(result)
        assert goal.tolerances is not None
        wanted, errors = goal.tolerances.goal, self._errors(self._reference())
        if errors is None or outcome.code == PATH_TOLERANCE_VIOLATED:
            return outcome
        violation = wanted.violation(*errors, self._names)
        if violation:
            return Outcome(GOAL_TOLERANCE_VIOLATED, violation)
        return Outcome(SUCCESSFUL, outcome.message) if wanted.given else outcome

    def _refusal(self, error: RobotsError) -> Outcome:
        return refusal_of(error)

    def _leave(self, goal: TrajectoryGoal) -> None:
        self._timer.cancel()
        self._moving.pop(goal.motion, None)

    def _stop_goal(self, goal: TrajectoryGoal) -> None:
        if goal.motion:
            self._stop_motion()
        else:
            resolve(goal.due)

    def ended(self, result: MotionResult) -> None:
        """A motion has ended; if it is the goal's, the goal has."""
        if (goal := self._moving.get(result.id)) is not None:
            resolve(goal.done, result)

    # -- while it moves -------------------------------------------------------------------------------

    def _poll(self) -> None:
        """Send feedback, and end a goal whose tolerances are violated."""
        goal = self._goal
        self._take_states()
        reference = self._reference()
        errors = self._errors(reference)
        if goal is None or goal.tolerances is None or errors is None or reference is None:
            return
        assert self._actual is not None
        feedback = self._action.Feedback(joint_names=self._names)
        feedback.header.stamp = self._node.get_clock().now().to_msg()
        for point, (q, q_dot) in (
            (feedback.desired, reference),
            (feedback.actual, self._actual),
            (feedback.error, errors),
        ):
            point.positions, point.velocities = doubles(q), doubles(q_dot)
        goal.handle.publish_feedback(feedback)
        if violation := goal.tolerances.path.violation(*errors, self._names):
            self._end(goal, Outcome(PATH_TOLERANCE_VIOLATED, violation))
        if goal.target is not None and not np.abs(reference[0] - goal.target).max() > AT_TARGET:
            now = self._node.now()
            goal.at_end = min(goal.at_end, now)
            if late := goal.tolerances.too_late(now - goal.at_end):
                self._end(goal, Outcome(GOAL_TOLERANCE_VIOLATED, late))

    def _take_states(self) -> None:
        message = self._states.take()
        if message is None:
            return
        with self._node.refusing('joint_states'):
            q, q_dot, _ = joint_motion(message, self._names)
            if q_dot is not None:
                self._actual = q, q_dot

    def _errors(self, reference: tuple[Array, Array] | None) -> tuple[Array, Array] | None:
        actual = self._actual
        if reference is None or actual is None:
            return None
        return reference[0] - actual[0], reference[1] - actual[1]


def tolerances_of(request: Any, names: list[str]) -> GoalTolerances:
    """The tolerances of a goal; 0 and -1 are none, as far as ours go.

    Raises:
        JointNamesError: a tolerance of a joint that the robot does not have.
        InvalidInputError: a tolerance below 0 that is not -1, or none at all.
    """

    def read(messages: Any, what: str) -> Tolerance:
        tolerance = Tolerance.none(len(names))
        for message in messages:
            if message.name not in names:
                raise JointNamesError(f'{what} of {message.name!r}; the joints are {", ".join(names)}')
            for values, value in (
                (tolerance.position, message.position),
                (tolerance.velocity, message.velocity),
            ):
                if not (value >= 0.0 or value == UNLIMITED):
                    raise InvalidInputError(
                        f'{what} of {message.name} is {value:g}; valid are numbers from 0 on, and -1 for none'
                    )
                values[names.index(message.name)] = value if value > 0.0 else math.inf
        return tolerance

    time = seconds(request.goal_time_tolerance)
    return GoalTolerances(
        read(request.path_tolerance, 'path_tolerance'), read(request.goal_tolerance, 'goal_tolerance'), time
    )


def refusal_of(error: RobotsError) -> Outcome:
    """Why a goal is not begun, as an answer to it."""
    return Outcome(INVALID_JOINTS if isinstance(error, JointNamesError) else INVALID_GOAL, error.message)


def outcome_of(result: MotionResult) -> Outcome:
    """A motion's result as an answer to a goal."""
    if result.ok:
        return Outcome(SUCCESSFUL, result.message)
    at_target = float(result.details.get('progress', 0.0)) >= 1.0
    return Outcome(GOAL_TOLERANCE_VIOLATED if at_target else PATH_TOLERANCE_VIOLATED, result.message)
