"""TrajectoryIntake: trajectories and points of streams as messages to the controller."""

from collections.abc import Callable
from typing import Any, Final

from trajectory_msgs.msg import JointTrajectory

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.motion_admission import MotionAdmission
from robots_controller.control.streamed_reference import StreamPoint
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import RobotsError
from robots_core.ros.joint_trajectories import SerializedTrajectory, single_point
from robots_core.ros.messages import NANOSECONDS, id_stamp, nanoseconds
from robots_core.ros.peers.heartbeat import FreshCommands
from robots_core.ros.peers.presence import Sender
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_planning.nodes.motion_messages import trajectory_from_message

CANCELED: Final = 'canceled by an empty joint_trajectory'


class TrajectoryIntake:
    """Takes `joint_trajectory`."""

    def __init__(
        self,
        node: RobotNode,
        control: ControlLoop,
        fresh: FreshCommands,
        publish: Callable[[MotionResult], None],
        report_cancellation: Callable[[str], None],
    ) -> None:
        self._node, self._control, self._fresh = node, control, fresh
        self._publish, self._report_cancellation = publish, report_cancellation
        self._names = list(node.robot.axes_data.names)
        self._admission = MotionAdmission(node.robot)
        self._subscription: Any = subscribe(
            node,
            JointTrajectory,
            'joint_trajectory',
            self._take,
            raw=True,
            from_anyone=lambda raw: not SerializedTrajectory(raw).num_points,  # it stops
        )

    def lose_commander(self, reason: str) -> None:
        """The commander of the robot is lost."""
        self._admission.lose_commander(reason, self._node.now())

    def planner_changed(self, reason: str) -> None:
        """The planner is lost, or is back ('')."""
        if reason:
            self._admission.lose_planner(reason, self._node.get_clock().now().nanoseconds)
        else:
            self._admission.planner_is_back(self._node.now())

    def _take(self, raw: bytes) -> None:
        message = SerializedTrajectory(raw)
        if not message.num_points:  # as in ros2_control: an empty trajectory cancels
            self._control.cancel(CANCELED)
            self._report_cancellation(CANCELED)
            return
        identified = getattr(self._subscription, 'identified', None)
        sender = Sender(time=0 if identified is None else identified.sent)
        if message.num_points == 1:
            self._fresh.check(sender)
            self._stream(message.message, message.id)
            return
        try:
            self._fresh.check(sender)
            self._admission.check_lost(self._node.now(), nanoseconds(id_stamp(message.id)))
            self._follow(message)
        except RobotsError as error:
            self._publish(MotionResult.refused(message.id, error))
            self._node.journal.error(f'joint_trajectory: {error}')

    def _follow(self, message: SerializedTrajectory) -> None:
        trajectory, join = trajectory_from_message(message, self._names)
        self._admission.check_limits(trajectory, joins=join != 0.0)
        self._control.follow(trajectory, message.id, join_time=join)

    def _stream(self, message: JointTrajectory, id_: str) -> None:
        """Take a point that is due `time_from_start` after its stamp, or from now, as in ros2_control."""
        position, velocity, acceleration = single_point(message, self._names, 'joint_trajectory')
        ahead = nanoseconds(message.points[0].time_from_start)
        if sent := nanoseconds(message.header.stamp):
            ahead += sent - self._node.get_clock().now().nanoseconds
        due = (round(self._node.now() * NANOSECONDS) + ahead) / NANOSECONDS
        point = StreamPoint(position, velocity, acceleration, due)
        self._control.stream(point, id_)
