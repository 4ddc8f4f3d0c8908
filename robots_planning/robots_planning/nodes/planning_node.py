"""planning_node: motion commands to verified joint trajectories."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.collision_detection import CollisionDetection, checked_margin
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.motion_result import MotionResult
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.pose import Pose
from robots_core.ros.message_class import message_class
from robots_core.ros.messages import (
    id_stamp,
    joint_values,
    motion_result_from_message,
    motion_result_message,
    pose_from_message,
    stamp_id,
)
from robots_core.ros.polled_subscription import PolledSubscription
from robots_core.ros.qos import COMMAND, PLANNER_ALIVE, STREAM
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.run import run
from robots_core.validation import Array
from robots_planning.command_planner import CommandPlanner, PlannedCommands
from robots_planning.command_queue import CommandQueue, QueuedCommand, RunningMotion
from robots_planning.motion_kinds import JOINT, LINE, MOTION_KINDS, MotionKind
from robots_planning.motion_results import PASSED
from robots_planning.motion_settings import DESCRIPTIONS, MotionSettings, checked
from robots_planning.nodes.command_inbox import CommandInbox
from robots_planning.nodes.follow_joint_trajectory import FollowJointTrajectory, waypoints_trajectory
from robots_planning.nodes.jogging import Jogging
from robots_planning.nodes.settings_publisher import SettingsPublisher
from robots_planning.nodes.trajectory_messages import BASE_FRAME, trajectory_message
from robots_planning.pathplanning import PathPlanning, PlannedMotion, Target
from robots_planning.standing_robot import check_standing

LOOK_PERIOD = 0.1  # s between looks for a first reference
# A blended motion waits so long for the one that it runs through to; then it stops at its end. A program that
# changes settings in between needs two questions and answers of busy processes for it.
BLEND_PATIENCE = 0.3  # s
COLLISION_MARGIN = 0.005  # m
NEW_COMMAND = ('queue', 'replace')


class PlanningNode(RobotNode):
    """Plans commands in their order, verifies the plans, and publishes them as `joint_trajectory`.

    A command that comes while the robot moves is planned at once and follows the motions before it. Planning
    has its own thread. A command that cannot be planned ends with a `motion_result` that says why; what
    becomes of a planned motion is told by the controller. `trigger` and `finished` are those of the paper's
    section 3.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__('planning_node', **options)
        self._declare_settings()
        self._names = list(self.robot.axes_data.names)
        collision = CollisionDetection(
            self.robot, engine=self.parameter('collision_engine', 'fcl', 'fcl or coal', read_only=True)
        )
        margin = self.parameter(
            'collision_margin', COLLISION_MARGIN, 'distance that motions keep, m', check=checked_margin
        )
        self._scene = WatchedScene(self, collision.set_scene)
        self._planning = PathPlanning(self.robot, collision=collision, collision_margin=margin)
        self._planning.warm_up()
        self._book = CommandQueue()
        self._inbox = CommandInbox(self)
        self._planner = CommandPlanner(
            self._planning,
            self._book,
            standing=self._standing_reference,
            path_time=self._path_time,
            send=self._send,
            refuse=self._refuse_order,
        )
        self._planner.replace = self._replaces(
            self.parameter(
                'new_command',
                NEW_COMMAND[0],
                'a joint motion commanded while the robot moves: queue it, or replace the running one',
                check=self._replaces,
            )
        )
        self._worker = ThreadPoolExecutor(1, 'planner')
        self._patience = self.create_timer(BLEND_PATIENCE, self._release, autostart=False)
        self._reference: tuple[Array, Array] | None = None
        self._reference_pose: Pose | None = None
        self._triggered = False
        self._controllers: set[bytes] = set()  # who published references when the last motion was sent
        self._progress = (0.0, 0.0)  # of the running motion, and when it was told

        self._references: PolledSubscription[JointTrajectory] = PolledSubscription(
            self, JointTrajectory, 'joint_reference', STREAM
        )
        self._trajectory_publisher = self.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
        self._result_publisher = self.create_publisher(DiagnosticStatus, 'motion_result', COMMAND)
        self._finished_publisher = self.create_publisher(Bool, 'finished', PLANNER_ALIVE)
        self._finished_publisher.publish(Bool(data=False))
        self._subscribe()
        self.add_post_set_parameters_callback(self._on_settings)
        SettingsPublisher(self, self._settings, self.robot_name)
        self._jogging = Jogging(
            self,
            standing=self._standing_reference,
            position=lambda message: self._reference_state(message)[0],
            busy=lambda: bool(self._book.running),
        )
        self._jogging.use_tool(self._settings().tool_pose)
        self._action: FollowJointTrajectory | None = None
        with contextlib.suppress(ImportError):  # control_msgs is no part of the common interfaces
            self._action = FollowJointTrajectory(
                self, lambda message, id_: self._worker.submit(self._send_given, message, id_)
            )
        self._look = self.create_timer(LOOK_PERIOD, self._look_for_reference)
        self.report_health(DiagnosticStatus.WARN, 'waiting for joint_reference')

    def _declare_settings(self) -> None:
        default = MotionSettings()
        for name, text in DESCRIPTIONS.items():
            value = getattr(default, name)
            self.parameter(
                name,
                list(value) if isinstance(value, tuple) else value,
                text,
                check=checked(name),
            )

    def _subscribe(self) -> None:
        readers = {'joints': self._joints, 'pose': self._pose, 'poses': self._poses}
        for kind in MOTION_KINDS:
            command = partial(self._command, kind, readers[kind.target])
            self.create_subscription(message_class(kind.message_type), kind.topic, command, COMMAND)
        self.create_subscription(DiagnosticStatus, 'motion_result', self._on_motion_result, COMMAND)
        self.create_subscription(Float64, 'motion_progress', self._on_progress, STREAM)
        self.create_subscription(PoseStamped, 'reference_pose', self._on_reference_pose, STREAM)
        self.create_subscription(Bool, 'trigger', self._on_trigger, COMMAND)

    @staticmethod
    def _replaces(value: str) -> bool:
        if value not in NEW_COMMAND:
            raise InvalidInputError(f'unknown new_command {value!r}; valid are {" and ".join(NEW_COMMAND)}')
        return value == 'replace'

    # -- commands ------------------------------------------------------------------------------------

    def _command(self, kind: MotionKind, read: Callable[[Any], Target], message: Any) -> None:
        stamp = message.header.stamp
        if stamp.sec == 0 and stamp.nanosec == 0:
            stamp = self.get_clock().now().to_msg()
        obey = partial(self._obey, kind, partial(read, message), stamp, self._settings())
        self._inbox.put(stamp, obey)

    def _obey(
        self,
        kind: MotionKind,
        target_of_it: Callable[[], Target],
        stamp: Time,
        settings: MotionSettings,
    ) -> None:
        id_ = stamp_id(stamp)
        if self._book.knows(id_):
            self.get_logger().warning(  # type: ignore[no-untyped-call]
                f'{kind.title}: command {id_} came twice, the second is ignored'
            )
            return
        try:
            target = target_of_it()
        except RobotsError as error:
            self._refuse_command(kind, id_, error)
            return
        order = QueuedCommand(id_, kind, target, settings, self._now())
        self._forget_lost_controller()
        self._submit(self._book.hold(order))
        if order.settings.blends:
            self._patience.reset()

    def _joints(self, message: JointState) -> Target:
        return joint_values(message.name, message.position, self._names, JOINT.topic)

    def _pose(self, message: PoseStamped) -> Pose:
        self._check_frame(message.header.frame_id)
        return pose_from_message(message.pose)

    def _poses(self, message: Path) -> Target:
        self._check_frame(message.header.frame_id)
        return tuple(self._pose(pose) for pose in message.poses)

    def _check_frame(self, frame: str) -> None:
        if frame not in ('', BASE_FRAME):
            raise InvalidInputError(f'frame {frame!r} is unknown; poses are given in {BASE_FRAME!r}')

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
        stamp, pose = self.get_clock().now().to_msg(), self._reference_pose

        def target() -> Pose:
            if pose is None:
                raise PlanningError('trigger came without a valid reference_pose before it')
            return pose

        self._inbox.put(stamp, partial(self._obey, LINE, target, stamp, self._settings()))

    def _settings(self) -> MotionSettings:
        values: dict[str, Any] = {name: self.get_parameter(name).value for name in DESCRIPTIONS}
        return MotionSettings(**values | {name: tuple(values[name]) for name in ('tool', 'base')})

    def _on_settings(self, parameters: list[Parameter]) -> None:
        self._inbox.deliver()  # what came before
        for parameter in parameters:
            if parameter.name == 'new_command':
                self._planner.replace = self._replaces(str(parameter.value))
            elif parameter.name == 'tool':
                self._jogging.use_tool(self._settings().tool_pose)
            elif parameter.name == 'collision_margin':
                self._planning.collision_margin = float(parameter.value)
        # Whoever switches blending off sends nothing that the motions held could run through to.
        names = {parameter.name for parameter in parameters}
        if names & {'blend_zone', 'joint_blend_zone'} and not self._settings().blends:
            self._release()

    def _release(self) -> None:
        self._patience.cancel()
        self._submit(self._book.release())

    def _submit(self, orders: tuple[QueuedCommand, ...]) -> None:
        if orders:
            self._worker.submit(self._planner.plan, orders).add_done_callback(self._on_planned)

    def _on_planned(self, future: Future[None]) -> None:
        if not future.cancelled() and (error := future.exception()) is not None:
            self.thread_failed(error)

    # -- the planner's thread ------------------------------------------------------------------------

    def _send(self, planned: PlannedCommands) -> None:
        titles = ' + '.join(order.kind.title for order in planned.orders)
        self._follow(planned.orders[-1].id, planned.motion, titles, planned.join_time)

    def _follow(self, id_: str, motion: PlannedMotion, title: str, join_time: float = 0.0) -> None:
        self._controllers = self._reference_publishers()
        if len(self._book.running) == 1:
            self._progress = (0.0, time.monotonic())
        self._finished_publisher.publish(Bool(data=False))
        message = trajectory_message(motion.trajectory, self._names, id_stamp(id_), join_time=join_time)
        self._trajectory_publisher.publish(message)
        limit = motion.report.limiting
        self.get_logger().info(  # type: ignore[no-untyped-call]
            f'{title} planned: {motion.duration:.3f} s, '
            f'limited by {100.0 * limit.ratio:.0f} % of the {limit.quantity} of {limit.joint}'
        )
        self.ready()

    def _send_given(self, message: JointTrajectory, id_: str) -> None:
        """Send the trajectory of somebody else.

        Raises:
            RobotsError: it breaks a limit, collides, or starts elsewhere; or the robot moves.
        """
        if self._book.running:
            raise PlanningError('the robot is still moving; wait for its motion_result or stop it')
        trajectory = waypoints_trajectory(message, self._names, self._standing_reference())
        motion = self._planning.checked(trajectory)
        self._book.planned(RunningMotion((id_,), trajectory, (trajectory.duration,)), self._book.failures)
        self._follow(id_, motion, 'a given trajectory')

    def _refuse_order(self, order: QueuedCommand, error: RobotsError) -> None:
        self._book.refused(order.id)
        self._refuse_command(order.kind, order.id, error)

    def _refuse_command(self, kind: MotionKind, id_: str, error: RobotsError) -> None:
        self.refuse(kind.topic, error)
        details = {key: str(value) for key, value in error.details.items()}
        self._answer(MotionResult(id_, ok=False, message=error.message, details=details))

    def _answer(self, result: MotionResult) -> None:
        self._result_publisher.publish(motion_result_message(result, self.robot_name))

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
        check_standing(q_dot, self.robot.axes_data)
        return q

    def _path_time(self) -> float:
        progress, told = self._progress
        running = self._book.running
        if not running:
            return 0.0
        # No override makes it faster than planned.
        return progress * running[0].trajectory.duration + max(0.0, time.monotonic() - told)

    # -- references and results ----------------------------------------------------------------------

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

    def _forget_lost_controller(self) -> None:
        if self._book.running and not self._controllers <= self._reference_publishers():
            self._book.forget()

    def _on_progress(self, message: Float64) -> None:
        self._progress = (message.data, time.monotonic())

    def _on_motion_result(self, message: DiagnosticStatus) -> None:
        result = motion_result_from_message(message)
        if self._action is not None:
            self._action.ended(result)
        ended = float(result.details.get('ended', self._now()))
        motion = self._book.ended(result.id, ok=result.ok, at=ended)
        if motion is None:
            return
        self._progress = (0.0, time.monotonic())  # of the one after it
        progress = 1.0 if result.ok else float(result.details.get('progress', 1.0))
        for id_, passed in motion.passed(progress):
            self._answer(MotionResult(id_, passed, PASSED if passed else result.message, result.details))
        if result.ok and not self._book.running:
            self._finished_publisher.publish(Bool(data=True))

    def _now(self) -> float:
        return 1e-9 * float(self.get_clock().now().nanoseconds)

    def destroy_node(self) -> None:
        """End the planning thread before what it uses."""
        self._worker.shutdown(cancel_futures=True)
        self._jogging.stop()
        if self._action is not None:
            self._action.destroy()
        super().destroy_node()  # type: ignore[no-untyped-call]


def main() -> None:
    """Start the node."""
    sys.exit(run(PlanningNode))


if __name__ == '__main__':
    main()
