"""inverse_kinematics_node with a controller and drives: poses and twists in, a stream of points out.

How references are followed is judged in test/unit: test_realtime_movement.py and test_simulated_guide.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped, TwistStamped
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.controller_node import ControllerNode
from robots_core import Pose, load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_core.nodes.inverse_kinematics_node import InverseKinematicsNode
from robots_core.ros.messages import pose_message
from robots_core.ros.qos import STATE

from .bench import Bench

NAME = 'kuka_kr500_r2830'
ROBOT = load_robot_model(NAME)
START = np.array([0.0, -1.3, 1.8, 0.0, 0.9, 0.0])
POSE = Pose(*ROBOT.direct_kinematics(START))
PATIENT = 20.0  # s, with drives that a busy machine delays
SEND_PERIOD = 0.02  # s
STANDING = 50  # references without velocity


class GuidedRobot(Bench):
    """A robot that follows references, and somebody who sends them."""

    def __init__(self, runner: Any, method: str = 'constrained') -> None:
        super().__init__(runner, 'sensor')
        self.references = self.collect('joint_reference', JointTrajectory, read=lambda m: m.points[0])
        self.stream = self.collect('joint_trajectory', JointTrajectory)
        self.start_node(DriveNode, robot_model=NAME, initial_position=START.tolist())
        self.start_node(ControllerNode, robot_model=NAME, feedback_timeout=PATIENT)
        self.ik = self.start_node(InverseKinematicsNode, robot_model=NAME, method=method)
        self.poses = self.publisher('reference_pose', PoseStamped)
        self.twists = self.publisher('reference_twist', TwistStamped)
        self.pose: Pose | None = None
        self.twist: np.ndarray | None = None
        self._timer = self.peer.create_timer(SEND_PERIOD, self._send)
        self.wait(lambda: self.references, 'first reference')

    def _send(self) -> None:
        stamp = self.peer.get_clock().now().to_msg()
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

    @property
    def q(self) -> np.ndarray:
        return np.array(self.references[-1].positions)

    def until_at(self, pose: Pose) -> None:
        self.wait(lambda: max(Pose(*ROBOT.direct_kinematics(self.q)).distance_to(pose)) < 1e-5, 'the pose')

    def until_standing(self) -> None:
        count = len(self.references)
        self.wait(
            lambda: (
                len(self.references) > count + STANDING
                and not any(any(point.velocities) for point in self.references[-STANDING:])
            ),
            'a standing robot',
        )


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares', 'analytical'])
def test_a_pose_is_followed_until_none_comes(ros_nodes: Any, method: str) -> None:
    bench = GuidedRobot(ros_nodes, method)
    bench.pose = Pose.from_angles(POSE.r + np.array([0.01, 0.02, -0.01]), POSE.angles() + 0.02)
    bench.until_at(bench.pose)
    bench.pose = None
    bench.until_standing()
    bench.until_health(DiagnosticStatus.WARN, 'no reference for 0.2 s')


def test_nan_is_refused_with_a_diagnostic_and_moves_nothing(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    message = PoseStamped(pose=pose_message(POSE))
    message.pose.position.x = float('nan')
    bench.poses.publish(message)
    bench.until_health(DiagnosticStatus.WARN, 'nan')
    assert not bench.stream
    np.testing.assert_array_equal(bench.q, START)


def test_a_twist_alone_is_servoed(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    bench.twist = np.array([0.0, 0.1, 0.05, 0.0, 0.0, 0.1])
    bench.wait(lambda: ROBOT.direct_kinematics(bench.q)[0][1] > POSE.r[1] + 0.02, 'a way of 0.02 m')
    bench.twist = None
    bench.until_standing()


def test_follows_only_while_the_program_lets_a_sensor_guide_the_robot(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    bench.publish('guide', String(data='NONE'), STATE)
    bench.wait(lambda: bench.ik._guide == 'NONE', 'the guide')
    bench.pose = Pose(POSE.r + np.array([0.0, 0.01, 0.0]), POSE.T)
    count = len(bench.references)
    bench.wait(lambda: len(bench.references) > count + 100, 'references')
    assert not bench.stream
    bench.publish('guide', String(data='SENSOR'), STATE)
    bench.until_at(bench.pose)
