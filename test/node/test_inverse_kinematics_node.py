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
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory

from bench import Bench
from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import Pose, load_robot_model
from robots_core.blocks.following.following_methods import METHODS
from robots_core.nodes.drive_node import DriveNode
from robots_core.nodes.inverse_kinematics_node import InverseKinematicsNode
from robots_core.ros.lockstep.phases import NANOSECONDS, Phase
from robots_core.ros.messages import BUILD, seconds
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode

NAME = 'kuka_kr500_r2830'
ROBOT = load_robot_model(NAME)
START = np.array([0.0, -1.3, 1.8, 0.0, 0.9, 0.0])
POSE = Pose(*ROBOT.direct_kinematics(START))
RATE = 125.0  # Hz, of the stream in lock-step
DT = 1.0 / RATE
SEND_PERIOD = 0.02  # s


class GuidedRobot(Bench):
    """A robot that follows references, and what sends them."""

    def __init__(self, runner: Any, method: str = 'constrained') -> None:
        super().__init__(runner, 'sensor')
        self.references = self.collect('joint_reference', JointTrajectory, read=lambda m: m.points[0])
        self.stream = self.collect('joint_trajectory', JointTrajectory)
        self.start_node(DriveNode, robot_model=NAME, initial_position=START.tolist(), **SPARSE)
        self.start_node(ControllerNode, robot_model=NAME, **LATE_DRIVES, **SPARSE)
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
            message = PoseStamped(pose=BUILD.pose(self.pose.r, self.pose.quaternion()))
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


@pytest.mark.parametrize('method', METHODS)
def test_a_pose_is_followed_until_none_comes(ros_nodes: Any, method: str) -> None:
    bench = GuidedRobot(ros_nodes, method)
    bench.pose = Pose.from_angles(POSE.r + np.array([0.01, 0.02, -0.01]), POSE.angles() + 0.02)
    bench.until_at(bench.pose)
    bench.pose = None
    bench.until_standing(bench.references)
    bench.until_health(DiagnosticStatus.WARN, 'no reference for 0.2 s')


def test_nan_is_refused_with_a_diagnostic_and_moves_nothing(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    message = PoseStamped(pose=BUILD.pose(POSE.r, POSE.quaternion()))
    message.pose.position.x = float('nan')
    bench.poses.publish(message)
    bench.until_health(DiagnosticStatus.WARN, 'nan')
    assert not bench.stream
    np.testing.assert_array_equal(bench.q, START)


def test_a_twist_alone_is_servoed(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    bench.twist = np.array([0.0, 0.1, 0.05, 0.0, 0.0, 0.1])
    bench.wait(lambda: ROBOT.direct_kinematics(bench.q)[0][1] > POSE.r[1] + 0.02, 'a distance of 0.02 m')
    bench.twist = None
    bench.until_standing(bench.references)


def test_follows_only_while_the_program_lets_a_sensor_guide_the_robot(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    bench.publish('guide', String(data='NONE'), STATE)
    bench.wait(lambda: bench.ik.commanders.guide == 'NONE', 'the guide')
    bench.pose = Pose(POSE.r + np.array([0.0, 0.01, 0.0]), POSE.T)
    count = len(bench.references)
    bench.wait(lambda: len(bench.references) > count + 25, 'references')
    assert not bench.stream
    bench.publish('guide', String(data='SENSOR'), STATE)
    bench.until_at(bench.pose)


def test_follows_only_while_nobody_else_commands_the_robot(ros_nodes: Any) -> None:
    bench = GuidedRobot(ros_nodes)
    assert bench.call('controller_node/commander/remote', SetBool.Request(data=True), SetBool).success
    bench.wait(lambda: bench.ik.commanders.commander == 'REMOTE', 'the commander')
    bench.pose = Pose(POSE.r + np.array([0.0, 0.01, 0.0]), POSE.T)
    count = len(bench.references)
    bench.wait(lambda: len(bench.references) > count + 25, 'references')
    assert not bench.stream
    bench.publish('guide', String(data='NONE'), STATE)
    assert bench.call('controller_node/take_over/sensor').success
    bench.until_at(bench.pose)


class JumpingSensor(TimedNode):
    """In lock-step: a reference that jumps to and fro, and the stream that follows it."""

    JUMP, END = 0.5, 2.0  # s

    def __init__(self, **options: Any) -> None:
        super().__init__('sensor', **options)
        self.points: list[tuple[float, np.ndarray]] = []
        away = Pose.from_angles(POSE.r + np.array([0.05, 0.1, -0.05]), POSE.angles() + 0.1)
        self._places = (POSE, away)
        self._poses = self.create_publisher(PoseStamped, 'reference_pose', COMMAND)
        self.create_subscription(JointTrajectory, 'joint_trajectory', self._on_point, COMMAND)
        self.start_loop(self._work, period=SEND_PERIOD, name='sensor', phase=Phase.ENVIRONMENT)

    def _work(self, now: float) -> None:
        if now < self.END:
            pose = self._places[int(now / self.JUMP) % 2]
            self._poses.publish(BUILD.pose_stamped(self.get_clock().now().to_msg(), pose))

    def _on_point(self, message: JointTrajectory) -> None:
        (point,) = message.points
        rows = np.array([point.positions, point.velocities, point.accelerations])
        self.points.append((seconds(message.header.stamp), rows))


@pytest.mark.parametrize('method', METHODS)
def test_each_sample_of_the_stream_keeps_the_limits(ros_nodes: Any, method: str) -> None:
    sensor = ros_nodes.add(JumpingSensor(**ros_nodes.options(lockstep=True)))
    bench = Bench(ros_nodes)
    robot = {'robot_model': NAME, 'rate': RATE, 'lockstep': True}
    bench.start_node(DriveNode, **robot, initial_position=START.tolist())
    bench.start_node(ControllerNode, **robot)
    bench.start_node(InverseKinematicsNode, **robot, method=method)
    run = ros_nodes.coordinate('sensor', 'drive_node', 'controller_node', 'inverse_kinematics_node')
    bench.wait(lambda: run.time > (sensor.END + 1.0) * NANOSECONDS, 'the end')
    ros_nodes.call(run.end)

    stamps = np.array([stamp for stamp, _ in sensor.points])
    np.testing.assert_allclose(np.diff(stamps), DT, rtol=1e-6)  # none is missing
    q, q_dot, q_ddot = np.moveaxis(np.array([rows for _, rows in sensor.points]), 1, 0)
    axes = ROBOT.axes_data
    assert (q >= axes.lower).all()
    assert (q <= axes.upper).all()
    within = 1.0 + 1e-5  # second differences over (8 ms)^2 round to 1e-9 rad/s^2
    for velocity in (q_dot, np.diff(q, axis=0) / DT):
        assert (np.abs(velocity) <= axes.velocity * within).all()
    for acceleration in (q_ddot, np.diff(q, 2, axis=0) / DT**2):
        assert (np.abs(acceleration) <= axes.acceleration * within).all()
    # The jumps are followed as fast as the limits permit, and the stream ends at rest.
    assert np.max(np.abs(q_ddot) / axes.acceleration) > 0.99
    assert not q_dot[-1].any()
