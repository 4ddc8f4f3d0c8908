"""Jogging through the nodes of planner, controller and drives.

How a jogged robot moves is judged in test/unit: test_teach_box.py and test_simulated_guide.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from bench import Bench
from late_drives import LATE_DRIVES
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import BUILD, motion_result_from_message, stamp_id
from robots_core.ros.qos import COMMAND
from robots_planning.nodes.planning_node import PlanningNode

NAME = 'bello_bot'
ROBOT = load_robot_model(NAME)
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)
JOG_PERIOD = 0.02  # s, well inside the dead-man's 0.1 s


class JoggedRobot(Bench):
    """A robot with its planner, and a teach box."""

    def __init__(self, runner: Any) -> None:
        super().__init__(runner, 'box')
        self.references = self.collect('joint_reference', JointTrajectory, read=lambda m: m.points[0])
        self.points = self.collect('joint_trajectory', JointTrajectory, read=lambda m: m.points[0])
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.start_node(DriveNode, robot_model=NAME)
        # The test's own threads may hold up drives and planner, which share their interpreter.
        self.controller = self.start_node(
            ControllerNode,
            robot_model=NAME,
            realtime_priority=0,
            **LATE_DRIVES,
            stream_timeout=0.5,
            operating_mode='T2',
        )
        self.planner = self.start_node(PlanningNode, robot_model=NAME)
        self._timer: Any = None
        self.wait(lambda: self.references, 'a robot that stands')

    def press(self, topic: str, message: Any) -> None:
        """Send a command again and again, with the time of each."""
        publisher = self.publisher(topic, type(message))

        def send() -> None:
            message.header.stamp = self.peer.get_clock().now().to_msg()
            publisher.publish(message)

        self.runner.call(lambda: setattr(self, '_timer', self.peer.create_timer(JOG_PERIOD, send)))

    def release(self) -> None:
        """Send nothing more."""
        self.runner.call(lambda: self.peer.destroy_timer(self._timer))

    def move(self, q: np.ndarray) -> MotionResult:
        """Command a motion; returns its result."""
        stamp = self.peer.get_clock().now().to_msg()
        self.publish('ptpjoint_joint', BUILD.joint_state(stamp, tuple(NAMES), q))
        return self.wait(
            lambda: next((result for result in self.results if result.id == stamp_id(stamp)), None),
            'a result',
        )

    def q(self) -> np.ndarray:
        return np.array(self.references[-1].positions)


@pytest.fixture
def bench(ros_nodes: Any) -> JoggedRobot:
    return JoggedRobot(ros_nodes)


def axis_command(axis: int, velocity: float) -> JointState:
    values = np.zeros(len(NAMES))
    values[axis] = velocity
    return JointState(name=NAMES, velocity=values.tolist())


def test_an_axis_moves_while_it_is_jogged_and_stops_without_commands(bench: JoggedRobot) -> None:
    bench.press('teach_joints', axis_command(1, 0.2))
    bench.wait(lambda: bench.q()[1] > HOME[1] + 0.01, 'axis 2 moves')
    bench.release()
    bench.until_standing(bench.references)
    q = bench.q()
    others = np.arange(len(NAMES)) != 1
    np.testing.assert_allclose(q[others], HOME[others], atol=1e-12)
    axes = ROBOT.axes_data
    asked = np.array([point.velocities for point in bench.points])
    assert (np.abs(asked) <= 0.1 * axes.velocity * (1.0 + 1e-9)).all()
    # The robot takes motions again once the stream is over.
    bench.wait(lambda: not bench.controller.moving, 'the end of the stream')
    bench.set_parameters(bench.controller, operating_mode='AUTOMATIC')
    bench.wait(lambda: bench.move(HOME).ok, 'a motion')


def test_a_jog_that_begins_as_another_ends_moves_the_robot(
    bench: JoggedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    jogging = bench.planner._jogging.jogging
    jog_axes = jogging.jog_axes

    def jog_as_the_stream_ends(*command: Any) -> bool:
        monkeypatch.undo()
        jogging.end()  # by the loop of the stream, in its own thread
        return jog_axes(*command)

    monkeypatch.setattr(jogging, 'active', True)
    monkeypatch.setattr(jogging, 'jog_axes', jog_as_the_stream_ends)
    bench.press('teach_joints', axis_command(1, 0.2))
    bench.wait(lambda: bench.q()[1] > HOME[1] + 0.01, 'axis 2 moves')


def test_a_tool_moves_along_its_own_axis(bench: JoggedRobot) -> None:
    r0, T0 = ROBOT.direct_kinematics(HOME)
    message = TwistStamped()
    message.header.frame_id = 'tool'
    message.twist.linear.z = -0.05
    bench.press('teach_twist', message)
    bench.wait(lambda: np.linalg.norm(ROBOT.direct_kinematics(bench.q())[0] - r0) > 0.005, 'the tool moves')
    bench.release()
    bench.until_standing(bench.references)
    distance = T0.T @ (ROBOT.direct_kinematics(bench.q())[0] - r0)
    assert np.abs(distance).argmax() == 2
    assert distance[2] < 0.0


def test_a_limit_stops_the_axis_and_is_named(bench: JoggedRobot) -> None:
    axis = int(np.argmin(ROBOT.axes_data.upper - HOME))  # the nearest
    upper, limit = ROBOT.axes_data.upper[axis], f'{ROBOT.axes_data.names[axis]} position upper'
    bench.press('teach_joints', axis_command(axis, 10.0))
    bench.until_health(DiagnosticStatus.WARN, limit)
    bench.wait(
        lambda: not any(bench.references[-1].velocities) and bench.q()[axis] > upper - 0.01, 'it stands'
    )
    assert bench.q()[axis] <= upper
    bench.release()


def test_commands_of_another_time_or_kind_are_refused(bench: JoggedRobot) -> None:
    old = axis_command(0, 0.2)
    old.header.stamp.sec = 1
    bench.publish('teach_joints', old)
    bench.until_health(DiagnosticStatus.WARN, 'allowed is 0.1 s: are the clocks')
    odd = TwistStamped()
    odd.header.frame_id = 'camera'
    bench.publish('teach_twist', odd)
    bench.until_health(DiagnosticStatus.WARN, "frame 'camera' is unknown")
    odd.header.frame_id = 'base'
    odd.twist.linear.x = float('nan')
    bench.publish('teach_twist', odd)
    bench.until_health(DiagnosticStatus.WARN, 'must be a finite number')
    np.testing.assert_array_equal(bench.q(), HOME)
