"""FollowJointTrajectory: what MoveIt and others send, served where control_msgs is installed."""

import concurrent.futures
from collections.abc import Callable
from typing import Any, Final

from rclpy.task import Future
from sensor_msgs.msg import JointState

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.ros.joint_trajectories import FIELDS, field_rows, point_times
from robots_core.ros.messages import doubles, joint_indices, joint_motion, seconds, stamp_id
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.validation import Array
from robots_planning.commands.goal_outcome import Outcome
from robots_planning.commands.trajectory_goal import Errors, Tolerance, TrajectoryGoal
from robots_planning.nodes.one_goal_server import Goal, OneGoalServer, resolve
from robots_planning.trajectory import Trajectory
from robots_planning.waypoints import trajectory_through

ACTION: Final = 'follow_joint_trajectory'
FEEDBACK_PERIOD: Final = 0.02  # s


def waypoints_trajectory(message: Any, names: list[str], start: Array, late: float = 0.0) -> Trajectory:
    """The motion of a client's trajectory_msgs/JointTrajectory, joints matched by name.

    Args:
        message: The trajectory.
        names: Joints of the robot.
        start: Where it stands, (n,).
        late: See `trajectory_through`.

    Raises:
        JointNamesError: a joint is missing or named twice.
        InvalidInputError: points of different kinds, or as `trajectory_through`.
    """
    joint_indices(message.joint_names, names, ACTION)
    time = point_times(message)
    given = [any(len(getattr(point, field)) for point in message.points) for field in FIELDS]
    rows = [
        field_rows(message, names, ACTION, field) if has else None
        for field, has in zip(FIELDS, given, strict=True)
    ]
    return trajectory_through(time, rows, start, late=late)


class ServedTrajectory(Goal):
    """A goal under way; see `Goal`."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self.motion = ''
        """Id of its motion; '' before it has begun."""
        self.trajectory: TrajectoryGoal | None = None
        """What is checked of it; None before it is read."""
        self.due = Future()


class FollowJointTrajectory(OneGoalServer[ServedTrajectory]):
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
        # By the id of the motion; a goal that is preempted still brakes.
        self._moving: dict[str, ServedTrajectory] = {}
        self._states = PolledSubscription(node, JointState, 'joint_states')
        self._actual: tuple[Array, Array] | None = None
        super().__init__(node, action, ACTION, ServedTrajectory, period=FEEDBACK_PERIOD)

    async def _run(self, goal: ServedTrajectory) -> Outcome:
        request = goal.handle.request
        message, now = request.trajectory, self._node.get_clock().now().nanoseconds * 1e-9
        goal.trajectory = checked = trajectory_goal(request, self._names)
        stamp = seconds(message.header.stamp)
        wait = stamp - now if stamp else 0.0
        if wait > 0.0:
            timer = self._node.create_timer(wait, lambda: resolve(goal.due))
            await goal.due
            self._node.destroy_timer(timer)
        if goal.stopped is not None:
            return goal.stopped
        # The id is known before the motion is: its result may come at once.
        goal.motion = stamp_id(self._node.get_clock().now().to_msg())
        self._moving[goal.motion] = goal
        started = Future()

        def make(q: Array) -> Trajectory:
            trajectory = waypoints_trajectory(message, self._names, q, max(0.0, -wait))
            checked.target = trajectory.position[-1]
            return trajectory

        self._start(make, goal.motion).add_done_callback(lambda sent: started.set_result(sent.exception()))
        error = await started
        if error is not None:
            self._moving.pop(goal.motion, None)
            raise error
        if goal.stopped is not None:  # before there was a motion to stop
            self._stop_motion()
        self._timer.reset()
        result = await goal.done
        self._take_states()
        return goal.stopped or checked.outcome(result, self._errors(self._reference()))

    def _stop_goal(self, goal: ServedTrajectory) -> None:
        if goal.motion:
            self._stop_motion()
        else:
            resolve(goal.due)

    def ended(self, result: MotionResult) -> None:
        """A motion has ended; if it is the goal's, the goal has."""
        if (goal := self._moving.pop(result.id, None)) is not None:
            resolve(goal.done, result)

    # -- while it moves -------------------------------------------------------------------------------

    def _poll(self) -> None:
        """See `OneGoalServer`; a goal whose tolerances are violated is ended."""
        goal = self._goal
        self._take_states()
        reference = self._reference()
        errors = self._errors(reference)
        if goal is None or goal.trajectory is None or errors is None or reference is None:
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
        if outcome := goal.trajectory.check(reference[0], errors, self._node.now()):
            self._end(goal, outcome)

    def _take_states(self) -> None:
        message = self._states.take()
        if message is None:
            return
        with self._node.refusing('joint_states'):
            q, q_dot, _ = joint_motion(message, self._names)
            if q_dot is not None:
                self._actual = q, q_dot

    def _errors(self, reference: tuple[Array, Array] | None) -> Errors | None:
        actual = self._actual
        if reference is None or actual is None:
            return None
        return reference[0] - actual[0], reference[1] - actual[1]


def trajectory_goal(request: Any, names: list[str]) -> TrajectoryGoal:
    """What is checked of a goal; raises as `Tolerance.wanted`."""

    def read(what: str) -> Tolerance:
        of = [(one.name, one.position, one.velocity) for one in getattr(request, what)]
        return Tolerance.wanted(of, names, what)

    time = seconds(request.goal_time_tolerance)
    return TrajectoryGoal(names, read('path_tolerance'), read('goal_tolerance'), time)
