"""planning_node: plans commanded motions and hands them to the controller."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from numpy.typing import ArrayLike
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool
from trajectory_msgs.msg import JointTrajectory

from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.nodes.messages import (
    MotionResult,
    joint_values,
    pose_from_message,
    stamp_id,
)
from robots_core.nodes.polled_subscription import PolledSubscription
from robots_core.nodes.qos import COMMAND, PLANNER_ALIVE, STREAM
from robots_core.nodes.robot_node import RobotNode
from robots_core.nodes.run import run
from robots_core.pose import Pose
from robots_core.validation import Array, positive
from robots_planning.nodes.trajectory_messages import BASE_FRAME, trajectory_message
from robots_planning.pathplanning import MotionSettings, PathPlanning
from robots_planning.robot_command_state import RobotCommandState
from robots_planning.trajectory_generators.base import usable_fraction

LOOK_PERIOD = 0.1  # s between looks for a first reference
# Who commands the next motion heard of the end of the last one; here that message may come a little later.
RESULT_DELAY = 0.2  # s
REST_SPEED = 1e-5  # rad/s (m/s); a reference this slow is rounding of one that stands


class PlanningNode(RobotNode):
    """Plans from the controller's reference, verifies the plan, and publishes it as `joint_trajectory`.

    A command that cannot be planned ends with a `motion_result` that says why; what becomes of a planned
    motion is told by the controller. `trigger` and `finished` are those of the paper's section 3.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('planning_node', **options)
        default = MotionSettings()
        for name, text, check in (
            ('speed_fraction', "part of the axes' velocity limits, (0, 1]", usable_fraction),
            (
                'acceleration_fraction',
                "part of the axes' acceleration and jerk limits, (0, 1]",
                usable_fraction,
            ),
            ('cartesian_speed', 'highest speed of the tool, m/s', positive),
            ('cartesian_acceleration', 'highest acceleration of the tool, m/s^2', positive),
            ('rotation_speed', 'highest angular speed of the tool, rad/s', positive),
            ('rotation_acceleration', 'highest angular acceleration of the tool, rad/s^2', positive),
        ):
            self.parameter(name, getattr(default, name), text, check=partial(check, name='the value'))
        self._settings_names = tuple(default.__dataclass_fields__)
        self._names = list(self.robot.axes_data.names)
        self._planning = PathPlanning(self.robot)
        self._planning.warm_up()
        self._reference: tuple[Array, Array] | None = None
        self._reference_pose: Pose | None = None
        self._triggered = False
        # The motion that the controller works on, and who published references when it was sent.
        self._motion = ''
        self._controllers: set[bytes] = set()
        self._waiting: Callable[[], None] | None = None
        self._patience = self.create_timer(RESULT_DELAY, self._answer_waiting, autostart=False)

        self._references: PolledSubscription[JointTrajectory] = PolledSubscription(
            self, JointTrajectory, 'joint_reference', STREAM
        )
        self._trajectory_publisher = self.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
        self._result_publisher = self.create_publisher(DiagnosticStatus, 'motion_result', COMMAND)
        self._finished_publisher = self.create_publisher(Bool, 'finished', PLANNER_ALIVE)
        self._finished_publisher.publish(Bool(data=False))
        self.create_subscription(DiagnosticStatus, 'motion_result', self._on_motion_result, COMMAND)
        self.create_subscription(JointState, 'ptpjoint_joint', self._on_ptpjoint_joint, COMMAND)
        self.create_subscription(PoseStamped, 'ptpjoint_cartesian', self._on_ptpjoint_cartesian, COMMAND)
        self.create_subscription(PoseStamped, 'ptpcartesian', self._on_ptpcartesian, COMMAND)
        self.create_subscription(PoseStamped, 'reference_pose', self._on_reference_pose, STREAM)
        self.create_subscription(Bool, 'trigger', self._on_trigger, COMMAND)
        self._look = self.create_timer(LOOK_PERIOD, self._look_for_reference)
        self.report_health(DiagnosticStatus.WARN, 'waiting for joint_reference')

    # -- commands ------------------------------------------------------------------------------------

    def _on_ptpjoint_joint(self, message: JointState) -> None:
        self._command(RobotCommandState.PTPJOINT_JOINT, message)

    def _on_ptpjoint_cartesian(self, message: PoseStamped) -> None:
        self._command(RobotCommandState.PTPJOINT_CARTESIAN, message)

    def _on_ptpcartesian(self, message: PoseStamped) -> None:
        self._command(RobotCommandState.PTPCARTESIAN, message)

    def _command(self, state: RobotCommandState, message: Any) -> None:
        stamp = message.header.stamp
        if stamp.sec == 0 and stamp.nanosec == 0:
            stamp = self.get_clock().now().to_msg()
        if stamp_id(stamp) == self._motion:
            self.get_logger().warning(  # type: ignore[no-untyped-call]
                f'{state}: command {self._motion} came twice, the second is ignored'
            )
            return
        try:
            target: Pose | ArrayLike
            if state is RobotCommandState.PTPJOINT_JOINT:
                target = joint_values(message.name, message.position, self._names, 'ptpjoint_joint')
            else:
                target = self._pose(message)
        except RobotsError as error:
            self._refuse_command(state, stamp, error)
            return
        self._request(state, target, stamp)

    def _on_reference_pose(self, message: PoseStamped) -> None:
        try:
            self._reference_pose = self._pose(message)
        except RobotsError as error:
            self._reference_pose = None
            self.refuse('reference_pose', error)

    def _on_trigger(self, message: Bool) -> None:
        rising, self._triggered = message.data and not self._triggered, message.data
        if not rising:
            return
        stamp = self.get_clock().now().to_msg()
        state = RobotCommandState.PTPCARTESIAN
        if self._reference_pose is None:
            error = PlanningError('trigger came without a valid reference_pose before it')
            self._refuse_command(state, stamp, error)
            return
        self._request(state, self._reference_pose, stamp)

    def _pose(self, message: PoseStamped) -> Pose:
        frame = message.header.frame_id
        if frame not in ('', BASE_FRAME):
            raise InvalidInputError(f'frame {frame!r} is unknown; poses are given in {BASE_FRAME!r}')
        return pose_from_message(message.pose)

    # -- planning ------------------------------------------------------------------------------------

    def _request(self, state: RobotCommandState, target: Pose | ArrayLike, stamp: Time) -> None:
        """Plan now, or as soon as the result of the motion before has come too."""
        request = partial(self._answer, state, target, stamp)
        if self._in_motion() and self._waiting is None:
            self._waiting = request
            self._patience.reset()
        else:
            request()

    def _answer_waiting(self) -> None:
        self._patience.cancel()
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            waiting()

    def _answer(self, state: RobotCommandState, target: Pose | ArrayLike, stamp: Time) -> None:
        try:
            self._plan(state, target, stamp)
        except RobotsError as error:
            self._refuse_command(state, stamp, error)

    def _plan(self, state: RobotCommandState, target: Pose | ArrayLike, stamp: Time) -> None:
        q_start = self._standing_reference()
        motion = self._planning.plan(state, q_start, target, self._settings())
        self._motion, self._controllers = stamp_id(stamp), self._reference_publishers()
        self._finished_publisher.publish(Bool(data=False))
        self._trajectory_publisher.publish(trajectory_message(motion.trajectory, self._names, stamp))
        limit = motion.report.limiting
        self.get_logger().info(  # type: ignore[no-untyped-call]
            f'{state} planned: {motion.duration:.3f} s, limited by {100.0 * limit.ratio:.0f} % of the '
            f'{limit.quantity} of {limit.joint}'
        )
        self.ready()

    def _settings(self) -> MotionSettings:
        return MotionSettings(**{name: self.get_parameter(name).value for name in self._settings_names})

    def _look_for_reference(self) -> None:
        """Ready as soon as there is a place to plan from."""
        message = self._references.take()
        if message is None:
            return
        try:
            self._reference = self._reference_state(message)
        except RobotsError as error:
            self.refuse('joint_reference', error, stream=True)
            return
        self.destroy_timer(self._look)
        self.ready()

    def _standing_reference(self) -> Array:
        """Where the controller's reference stands, (n,).

        Raises:
            PlanningError: no reference came yet, or the robot moves.
        """
        message = self._references.take()
        if message is not None:
            self._reference = self._reference_state(message)
        if self._reference is None:
            raise PlanningError(
                'no joint_reference received: is controller_node running and does the robot publish '
                'joint_states?'
            )
        q, q_dot = self._reference
        if self._in_motion():
            raise PlanningError(
                f'the robot is still moving: motion {self._motion} has not ended; wait for its '
                'motion_result or stop it'
            )
        fastest = int(np.argmax(np.abs(q_dot)))
        if abs(q_dot[fastest]) > REST_SPEED:
            raise PlanningError(
                f'the robot is still moving: the reference of {self._names[fastest]} has '
                f'{q_dot[fastest]:.4g} {self.robot.axes_data.unit(fastest)}/s; wait until it stands'
            )
        return q

    def _in_motion(self) -> bool:
        """A motion was sent, its result has not come, and its controller is still there."""
        return bool(self._motion) and self._controllers <= self._reference_publishers()

    def _reference_state(self, message: JointTrajectory) -> tuple[Array, Array]:
        if len(message.points) != 1:
            raise InvalidInputError(f'joint_reference has {len(message.points)} points, expected is 1')
        point, names = message.points[0], message.joint_names
        q = joint_values(names, point.positions, self._names, 'joint_reference')
        q_dot = joint_values(names, point.velocities, self._names, 'joint_reference velocities')
        return q, q_dot

    def _reference_publishers(self) -> set[bytes]:
        # By endpoint: a controller that was started anew knows nothing of the motion.
        return {bytes(item.endpoint_gid) for item in self.get_publishers_info_by_topic('joint_reference')}

    # -- results -------------------------------------------------------------------------------------

    def _refuse_command(self, state: RobotCommandState, stamp: Time, error: RobotsError) -> None:
        self.refuse(state.value.lower(), error)
        details = {key: str(value) for key, value in error.details.items()}
        result = MotionResult(stamp_id(stamp), ok=False, message=error.message, details=details)
        self._result_publisher.publish(result.to_message(self.robot_name))

    def _on_motion_result(self, message: DiagnosticStatus) -> None:
        result = MotionResult.from_message(message)
        if self._motion and result.id == self._motion:
            self._motion = ''
            if result.ok:
                self._finished_publisher.publish(Bool(data=True))
            self._answer_waiting()


def main() -> None:
    """Start the node."""
    sys.exit(run(PlanningNode))


if __name__ == '__main__':
    main()
