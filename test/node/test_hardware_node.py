"""hardware_node between a controller and a driver, which the test stands in for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from robots_core import load_robot_model
from robots_core.cell_interface.driver_file import Driver, read_driver
from robots_core.errors import InvalidInputError
from robots_core.nodes.hardware_node import HardwareNode
from robots_core.ros.messages import doubles, seconds
from robots_core.ros.qos import STATE
from trajectory_controller_double import TrajectoryControllerDouble

ROBOT = load_robot_model('ur5e')
NAMES = list(ROBOT.axes_data.names)
DRIVER = """trajectory: /scaled_joint_trajectory_controller/joint_trajectory
joint_states: /driver/joint_states
lead: 0.05
speed_scaling: {topic: /speed_scaling_state_broadcaster/speed_scaling}
running: /io_and_status_controller/robot_program_running
"""


class HardwareBench(Bench):
    """The node with a driver whose robot moves as its controller computes, on the clock of the messages."""

    def __init__(self, runner: Any, folder: Path) -> None:
        super().__init__(runner)
        (folder / 'driver.yaml').write_text(DRIVER)
        driver = read_driver(folder / 'driver.yaml')
        self.controller = TrajectoryControllerDouble(NAMES, np.array(ROBOT.home))
        self.rejected: list[str] = []
        self.taken = 0
        self.states = self.collect('joint_states', JointState)
        self.running = self.collect('robot_running', Bool, STATE, lambda message: message.data)
        self.scaling = self.collect('speed_scaling', Float64, STATE, lambda message: message.data)
        self.node = self.start_node(
            HardwareNode,
            robot_model='ur5e',
            driver=str(folder / 'driver.yaml'),
            realtime_priority=0,
        )
        self.publisher(driver.running, Bool, STATE)
        self.publisher(driver.speed_scaling, Float64)
        self.publisher('drives_on', Bool, STATE)
        measured = self.publisher(driver.joint_states, JointState)
        self.peer.create_subscription(JointTrajectory, driver.trajectory, self._follow, 10)
        self.peer.create_timer(0.01, lambda: measured.publish(self._measured()))
        self._reference = np.array(ROBOT.home), np.zeros(6)
        references = self.publisher('joint_reference', JointTrajectory, STATE)
        self.peer.create_timer(0.01, lambda: references.publish(self._referred()))

    def _now(self) -> float:
        return self.peer.get_clock().now().nanoseconds / 1e9

    def _follow(self, message: JointTrajectory) -> None:
        points = [
            (one.time_from_start.sec + 1e-9 * one.time_from_start.nanosec, one.positions, one.velocities)
            for one in message.points
        ]
        reason = self.controller.put(
            self._now(), message.joint_names, points, stamp=seconds(message.header.stamp)
        )
        self.taken += 1
        if reason:
            self.rejected.append(reason)

    def _measured(self) -> JointState:
        """In another order, and with a joint more, as drivers with grippers send them."""
        position, velocity = self.controller.step(self._now())
        state = JointState(name=[*NAMES[::-1], 'finger'])
        state.position, state.velocity = [*position[::-1], 0.4], [*velocity[::-1], 0.0]
        return state

    def _referred(self) -> JointTrajectory:
        q, q_dot = self._reference
        point = JointTrajectoryPoint(positions=doubles(q), velocities=doubles(q_dot))
        message = JointTrajectory(joint_names=NAMES, points=[point])
        message.header.stamp = self.peer.get_clock().now().to_msg()
        return message

    def refer(self, q: np.ndarray) -> None:
        """Send these references from now on, at rest."""
        self._reference = q, np.zeros(6)

    def until_at(self, q: np.ndarray) -> None:
        """Wait until the robot is there."""
        self.wait(lambda: np.abs(self.controller.step(self._now())[0] - q).max() < 1e-6, 'the position')


def test_a_robot_behind_a_driver_follows_and_reports(ros_nodes: Any, tmp_path: Path) -> None:
    bench = HardwareBench(ros_nodes, tmp_path)
    bench.wait(lambda: bench.states and bench.taken, 'feedback and trajectories')
    state = bench.states[-1]
    assert state.name == [*NAMES[::-1], 'finger']
    np.testing.assert_allclose(state.position[:6], ROBOT.home[::-1])
    near = np.array(ROBOT.home) + 1e-3
    bench.refer(near)
    bench.until_at(near)
    assert bench.rejected == []

    bench.publish('/speed_scaling_state_broadcaster/speed_scaling', Float64(data=40.0))
    bench.wait(lambda: bench.scaling and bench.scaling[-1] == pytest.approx(0.4), 'the scaling')
    bench.publish('/io_and_status_controller/robot_program_running', Bool(data=False), STATE)
    bench.wait(lambda: bench.running and not bench.running[-1], 'the stop')
    bench.wait(
        lambda: any(one.message == 'the robot has stopped by itself' for one in bench.health), 'the reason'
    )
    taken = bench.taken
    bench.refer(np.array(ROBOT.home))
    bench.wait(lambda: bench.states[-1] is not state, 'feedback')
    bench.publish('/io_and_status_controller/robot_program_running', Bool(data=True), STATE)
    bench.wait(lambda: bench.running[-1], 'the end of the stop')
    bench.until_at(np.array(ROBOT.home))
    assert bench.taken > taken
    assert bench.rejected == []


@pytest.mark.parametrize(
    ('text', 'complaint'),
    [
        (
            'trajectory: joint_trajectory\n',
            "driver.yaml:1: trajectory is 'joint_trajectory', and must be a whole",
        ),
        ('lead: 2\n', 'driver.yaml:1: lead is 2'),
        ('speed_scaling: {full: 100}\n', 'topic'),
        ('speed: 1\n', "'speed'"),
    ],
)
def test_a_file_that_describes_no_driver_is_refused(text: str, complaint: str, tmp_path: Path) -> None:
    path = tmp_path / 'driver.yaml'
    path.write_text(text)
    with pytest.raises(InvalidInputError, match=complaint):
        read_driver(path)


def test_an_empty_file_is_a_driver_with_the_usual_topics(tmp_path: Path) -> None:
    path = tmp_path / 'driver.yaml'
    path.write_text('lead: 0.02\n')
    assert read_driver(path) == Driver()
