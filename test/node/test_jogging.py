"""Jogging through the real planner, controller and drives."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import TwistStamped
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import joint_state_message, motion_result_from_message
from robots_core.ros.qos import COMMAND
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = load_robot_model('bello_bot')
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)
MANY = QoSProfile(depth=1000)
JOG_PERIOD = 0.02  # s, well inside the dead-man's 0.1 s


class Bench:
    """A robot with its planner, and somebody with a teach box."""

    def __init__(self, nodes: Any, planner_nodes: Any) -> None:
        self.nodes = nodes
        robot, ordinary = Parameter('robot_model', value='bello_bot'), Parameter('realtime_priority', value=0)
        options: dict[str, Any] = {'context': nodes.context}
        # The test's own threads may hold up the stream of a planner that shares their interpreter.
        patient = Parameter('stream_timeout', value=0.5)
        for kind, parameters in ((DriveNode, [robot]), (ControllerNode, [robot, ordinary, patient])):
            nodes.add(kind(**options, parameter_overrides=parameters))
        # Within one participant, the middleware does not assert the planner's liveliness.
        planner_nodes.add(PlanningNode(context=planner_nodes.context, parameter_overrides=[robot]))
        node = self.node = nodes.create_node('box')
        self.references: list[np.ndarray] = []
        self.points: list[np.ndarray] = []
        self.results: list[MotionResult] = []
        self.warnings: list[str] = []
        self.twists = node.create_publisher(TwistStamped, 'teach_twist', COMMAND)
        self.joints = node.create_publisher(JointState, 'teach_joints', COMMAND)
        self.motions = node.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
        for topic, received in (('joint_reference', self.references), ('joint_trajectory', self.points)):
            node.create_subscription(JointTrajectory, topic, partial(self._on_point, received), MANY)
        node.create_subscription(
            DiagnosticStatus,
            'motion_result',
            lambda m: self.results.append(motion_result_from_message(m)),
            COMMAND,
        )
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, MANY)
        self._timer: Any = None
        self.wait(
            lambda: (
                self.references
                and all(p.get_subscription_count() for p in (self.twists, self.joints, self.motions))
            ),
            'a robot that stands',
        )

    def _on_point(self, received: list[np.ndarray], message: JointTrajectory) -> None:
        point = message.points[0]
        received.append(np.array([point.positions, point.velocities, point.accelerations]))

    def _on_health(self, message: DiagnosticArray) -> None:
        self.warnings += [
            s.message for s in message.status if s.name == '/planning_node' and s.level != DiagnosticStatus.OK
        ]

    def wait(self, condition: Callable[[], Any], what: str) -> None:
        self.nodes.wait_for(condition, what=what)

    def press(self, publisher: Any, message: Any) -> None:
        """Send a command again and again, with the time of each."""

        def send() -> None:
            message.header.stamp = self.node.get_clock().now().to_msg()
            publisher.publish(message)

        self.nodes.call(lambda: setattr(self, '_timer', self.node.create_timer(JOG_PERIOD, send)))

    def release(self) -> None:
        """Send nothing more."""
        self.nodes.call(lambda: self.node.destroy_timer(self._timer))

    def until_standing(self) -> None:
        count = len(self.references)
        self.wait(
            lambda: len(self.references) > count + 50 and not np.array(self.references[-50:])[:, 1].any(),
            'a robot that stands',
        )

    def q(self) -> np.ndarray:
        return self.references[-1][0]


@pytest.fixture
def bench(ros_nodes: Any, more_ros_nodes: Any) -> Bench:
    return Bench(ros_nodes, more_ros_nodes)


def axis_command(axis: int, velocity: float) -> JointState:
    values = np.zeros(len(NAMES))
    values[axis] = velocity
    return JointState(name=NAMES, velocity=values.tolist())


def test_an_axis_moves_while_it_is_jogged_and_stops_when_nobody_does(bench: Bench) -> None:
    bench.press(bench.joints, axis_command(1, 0.2))
    bench.wait(lambda: bench.q()[1] > HOME[1] + 0.05, 'axis 2 moves')
    bench.release()
    bench.until_standing()
    q = bench.q()
    others = np.arange(len(NAMES)) != 1
    np.testing.assert_allclose(q[others], HOME[others], atol=1e-12)
    # What is asked for is slow; the controller may catch up with a late point inside the axis limits.
    axes = ROBOT.axes_data
    asked, references = np.array(bench.points), np.array(bench.references)
    assert (np.abs(asked[:, 1]) <= 0.1 * axes.velocity * (1.0 + 1e-9)).all()
    assert (np.abs(references[:, 2]) <= axes.acceleration * (1.0 + 1e-9)).all()
    # The robot takes motions again once the stream is over.
    bench.wait(lambda: bench.results, 'the end of the stream')
    assert bench.results[-1].ok
    bench.motions.publish(joint_state_message(bench.node.get_clock().now().to_msg(), tuple(NAMES), HOME))
    bench.wait(lambda: len(bench.results) > 1, 'the result of a motion')
    assert bench.results[-1].ok, bench.results[-1].message


def test_a_tool_moves_straight_along_its_own_axis(bench: Bench) -> None:
    r0, T0 = ROBOT.direct_kinematics(HOME)
    message = TwistStamped()
    message.header.frame_id = 'tool'
    message.twist.linear.z = -0.05
    bench.press(bench.twists, message)
    bench.wait(lambda: np.linalg.norm(ROBOT.direct_kinematics(bench.q())[0] - r0) > 0.02, 'the tool moves')
    bench.release()
    bench.until_standing()
    r, T = ROBOT.direct_kinematics(bench.q())
    way = T0.T @ (r - r0)
    assert way[2] < -0.02
    # Braking leaves the line by what the axes need to stop one by one from a slow jog.
    assert np.abs(way[:2]).max() < 1e-3
    np.testing.assert_allclose(T, T0, atol=5e-3)


def test_a_limit_stops_the_axis_and_is_named(bench: Bench) -> None:
    axis = int(np.argmin(ROBOT.axes_data.upper - HOME))  # the nearest
    upper, limit = ROBOT.axes_data.upper[axis], f'{ROBOT.axes_data.names[axis]} position upper'
    bench.press(bench.joints, axis_command(axis, 10.0))
    bench.wait(lambda: any(limit in text for text in bench.warnings), 'the limit is named')
    bench.wait(lambda: not bench.references[-1][1].any() and bench.q()[axis] > upper - 0.01, 'it stands')
    assert bench.q()[axis] <= upper
    bench.release()


def test_commands_of_another_time_or_kind_are_refused(bench: Bench) -> None:
    old = axis_command(0, 0.2)
    old.header.stamp.sec = 1
    bench.joints.publish(old)
    bench.wait(lambda: any('allowed is 0.1 s: are the clocks' in text for text in bench.warnings), 'age told')
    odd = TwistStamped()
    odd.header.frame_id = 'camera'
    bench.twists.publish(odd)
    bench.wait(lambda: any("frame 'camera' is unknown" in text for text in bench.warnings), 'frame told')
    odd.header.frame_id = 'base'
    odd.twist.linear.x = float('nan')
    bench.twists.publish(odd)
    bench.wait(lambda: any('must be a finite number' in text for text in bench.warnings), 'NaN told')
    np.testing.assert_array_equal(bench.q(), HOME)
