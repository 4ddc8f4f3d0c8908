"""inverse_kinematics_node with a controller and drives, over real topics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.controller_node import ControllerNode
from robots_core import Pose, load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_core.nodes.inverse_kinematics_node import InverseKinematicsNode
from robots_core.ros.messages import pose_message
from robots_core.ros.qos import COMMAND, STATE

ROBOT = load_robot_model('kuka_kr500_r2830')
AXES = ROBOT.axes_data
START = np.array([0.0, -1.3, 1.8, 0.0, 0.9, 0.0])
POSE = Pose(*ROBOT.direct_kinematics(START))
MANY = QoSProfile(depth=1000)
SEND_PERIOD = 0.02  # s
DT = 0.004


class Bench:
    """A robot that follows references, and somebody who sends them."""

    def __init__(self, nodes: Any, method: str = 'constrained') -> None:
        self.nodes = nodes
        options: dict[str, Any] = {'context': nodes.context}
        robot = Parameter('robot_model', value='kuka_kr500_r2830')
        start = Parameter('initial_position', value=START.tolist())
        self.drive = DriveNode(**options, parameter_overrides=[robot, start])
        self.controller = ControllerNode(**options, parameter_overrides=[robot])
        self.ik = InverseKinematicsNode(
            **options, parameter_overrides=[robot, Parameter('method', value=method)]
        )
        node = self.node = nodes.create_node('sensor')
        self.references: list[np.ndarray] = []
        self.stream = 0
        self.messages: set[tuple[bytes, str]] = set()
        self.poses = node.create_publisher(PoseStamped, 'reference_pose', COMMAND)
        self.twists = node.create_publisher(TwistStamped, 'reference_twist', COMMAND)
        self.command_state = node.create_publisher(String, 'command_state', STATE)
        node.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, MANY)
        node.create_subscription(JointTrajectory, 'joint_trajectory', self._on_stream, MANY)
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, MANY)
        self._timer = node.create_timer(SEND_PERIOD, self._send)
        self.pose: Pose | None = None
        self.twist: np.ndarray | None = None
        for one in (self.drive, self.controller, self.ik):
            nodes.add(one)
        self.wait(lambda: self.references and self.poses.get_subscription_count(), 'first reference')

    def _on_reference(self, message: JointTrajectory) -> None:
        self.references.append(np.array(message.points[0].positions))

    def _on_stream(self, message: JointTrajectory) -> None:
        self.stream += len(message.points)

    def _on_health(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if 'inverse_kinematics_node' in status.name:
                self.messages.add((status.level, status.message))

    def _send(self) -> None:
        stamp = self.node.get_clock().now().to_msg()
        if self.pose is not None:
            message = PoseStamped(pose=pose_message(self.pose))
            message.header.stamp = stamp
            self.poses.publish(message)
        if self.twist is not None:
            twist = TwistStamped()
            twist.header.stamp = stamp
            v, w = twist.twist.linear, twist.twist.angular
            v.x, v.y, v.z, w.x, w.y, w.z = map(float, self.twist)
            self.twists.publish(twist)

    def wait(self, condition: Any, what: str) -> None:
        self.nodes.wait_for(condition, what=what)

    def off(self, pose: Pose) -> float:
        return max(Pose(*ROBOT.direct_kinematics(self.references[-1])).distance_to(pose))

    def until_standing(self) -> None:
        count = len(self.references)
        self.wait(
            lambda: len(self.references) > count + 50 and np.ptp(self.references[-50:], axis=0).max() == 0.0,
            'a standing robot',
        )

    def check_limits(self) -> None:
        q = np.array(self.references)
        within = 1.0 + 1e-5  # second differences over (4 ms)^2 round to 1e-9 rad/s^2
        assert (np.abs(np.diff(q, axis=0)) <= AXES.velocity * DT * within).all()
        assert (np.abs(np.diff(q, 2, axis=0)) <= AXES.acceleration * DT**2 * within).all()


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares', 'analytical'])
def test_a_jump_of_the_reference_is_followed_inside_the_limits(ros_nodes: Any, method: str) -> None:
    bench = Bench(ros_nodes, method)
    bench.pose = Pose.from_angles(POSE.r + np.array([0.05, 0.1, -0.05]), POSE.angles() + 0.1)
    bench.wait(lambda: bench.off(bench.pose) < 1e-5, 'the pose')
    bench.check_limits()
    bench.pose = None
    bench.until_standing()


def test_a_stale_reference_brakes_to_a_stop_on_limits(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    bench.pose = Pose(POSE.r + np.array([0.0, 1.0, 0.0]), POSE.T)
    bench.wait(lambda: np.abs(bench.references[-1] - START).max() > 0.05, 'a moving robot')
    bench.pose = None
    bench.until_standing()
    bench.check_limits()
    bench.wait(
        lambda: any('no reference for 0.2 s' in message for _, message in bench.messages), 'a diagnostic'
    )
    assert bench.off(Pose(POSE.r + np.array([0.0, 1.0, 0.0]), POSE.T)) > 0.1


def test_nan_is_refused_with_a_diagnostic_and_moves_nothing(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    message = PoseStamped(pose=pose_message(POSE))
    message.pose.position.x = float('nan')
    bench.poses.publish(message)
    bench.wait(
        lambda: any(
            level == DiagnosticStatus.WARN and 'nan' in text.lower() for level, text in bench.messages
        ),
        'a diagnostic',
    )
    assert bench.stream == 0
    np.testing.assert_array_equal(bench.references[-1], START)


def test_a_twist_alone_is_servoed(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    bench.twist = np.array([0.0, 0.1, 0.05, 0.0, 0.0, 0.1])
    bench.wait(
        lambda: ROBOT.direct_kinematics(bench.references[-1])[0][1] > POSE.r[1] + 0.1, 'a way of 0.1 m'
    )
    bench.twist = None
    bench.until_standing()
    bench.check_limits()
    r, _ = ROBOT.direct_kinematics(bench.references[-1])
    away = r - POSE.r
    assert away[2] == pytest.approx(0.5 * away[1], abs=2e-3)
    assert abs(away[0]) < 2e-3


def test_follows_in_state_trajectory_only(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    bench.command_state.publish(String(data='IDLE'))
    bench.wait(lambda: bench.ik._command_state == 'IDLE', 'the state')
    bench.pose = Pose(POSE.r + np.array([0.0, 0.05, 0.0]), POSE.T)
    count = len(bench.references)
    bench.wait(lambda: len(bench.references) > count + 100, 'references')
    assert bench.stream == 0
    bench.command_state.publish(String(data='TRAJECTORY'))
    bench.wait(lambda: bench.off(bench.pose) < 1e-5, 'the pose')
    bench.check_limits()
