"""force_control_node and wheel_soil_node in lock-step, with a robot that stands and a made-up sensor."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TwistStamped, WrenchStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, String

from robots_controller.cell.contact_setup import read_contact
from robots_controller.nodes.force_control_node import ForceControlNode
from robots_controller.nodes.wheel_soil_node import WheelSoilNode
from robots_core import Pose, load_robot_model
from robots_core.blocks import ForceControl
from robots_core.ros.lockstep.phases import START, Phase
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode

CONTACT = Path(__file__).parents[2] / 'programs' / 'wheel_laboratory' / 'regolith_simulant.yaml'
ROBOT = load_robot_model('kuka_kr210_r3100')
SETUP = read_contact(CONTACT)
DT = 0.004  # s
HANDED_OVER, STOPS, TAKEN_BACK, ENDS = 20, 60, 200, 230  # periods
NAN = 40  # period with a broken sample
LOAD, SPEED, FORCE = 60.0, 0.03, 40.0  # N, m/s, N


def standing(depth: float) -> np.ndarray:
    """Joint positions with the wheel's lowest point at a depth in the soil."""
    height = SETUP.bed.height - depth + SETUP.wheel.radius + SETUP.hub[2]
    pose = Pose.from_angles([1.8, 0.0, height], np.radians([90.0, 0.0, 180.0]))
    found = ROBOT.inverse_kinematics_analytic(pose.r, pose.T)
    return np.asarray(found[np.abs(found).max(axis=1).argmin()])


class Laboratory(TimedNode):
    """A program that hands its robot over, drives, and in one of the tests a sensor that falls silent."""

    # After force control, which takes what was sent in the period before, on every machine alike.
    phase = Phase.OBSERVE

    def __init__(self, *, depth: float, sensor: bool, **options: Any) -> None:
        super().__init__('laboratory', **options)
        self.twists: list[tuple[int, np.ndarray]] = []
        self.problems: list[tuple[int, str]] = []
        self.wrenches: list[np.ndarray] = []
        self.period = 0
        self._q, self._sensor = standing(depth), sensor
        self._states = self.create_publisher(JointState, 'joint_states', STATE)
        self._guide = self.create_publisher(String, 'guide', STATE)
        self._outputs = self.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
        if sensor:
            self._wrench = self.create_publisher(WrenchStamped, 'measured_wrench', STATE)
        else:
            self.create_subscription(WrenchStamped, 'measured_wrench', self._on_wrench, COMMAND)
        self.create_subscription(TwistStamped, 'reference_twist', self._on_twist, COMMAND)
        self.create_subscription(DiagnosticStatus, 'contact_status', self._on_status, COMMAND)
        self.start_loop(self._work, period=DT, name='laboratory')

    def _on_twist(self, message: TwistStamped) -> None:
        v, w = message.twist.linear, message.twist.angular
        stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
        self.twists.append((round((stamp - START) / 1e9 / DT), np.array([v.x, v.y, v.z, w.x, w.y, w.z])))

    def _on_status(self, message: DiagnosticStatus) -> None:
        self.problems.append((self.period, message.message))

    def _on_wrench(self, message: WrenchStamped) -> None:
        assert message.header.frame_id == 'tool0'
        f, m = message.wrench.force, message.wrench.torque
        self.wrenches.append(np.array([f.x, f.y, f.z, m.x, m.y, m.z]))

    def _work(self, now: float) -> None:
        self.period = round((now - START / 1e9) / DT)
        if self.period == 0:
            self._outputs.publish(Float64MultiArray(data=[LOAD, SPEED, 0.3]))
        if self.period in {HANDED_OVER, TAKEN_BACK}:
            self._guide.publish(String(data='SENSOR' if self.period == HANDED_OVER else 'NONE'))
        state = JointState(name=list(ROBOT.axes_data.names), position=self._q.tolist(), velocity=[0.0] * 6)
        self._states.publish(state)
        if self._sensor and self.period < STOPS:
            message = WrenchStamped()
            message.header.frame_id = 'tool0'
            force = -FORCE if self.period >= HANDED_OVER else 0.0  # tool0 points down
            message.wrench.force.z = float('nan') if self.period == NAN else force
            self._wrench.publish(message)


def run(ros_nodes: Any, *, depth: float, sensor: bool) -> Laboratory:
    parameters = {'lockstep': True, 'robot_model': ROBOT.name, 'contact': str(CONTACT)}
    laboratory = ros_nodes.add(Laboratory(depth=depth, sensor=sensor, **ros_nodes.options(lockstep=True)))
    names = ['laboratory', 'force_control_node']
    ros_nodes.add(ForceControlNode(**ros_nodes.options(**parameters)))
    if not sensor:
        ros_nodes.add(WheelSoilNode(**ros_nodes.options(**parameters)))
        names.append('wheel_soil_node')
    coordinator = ros_nodes.coordinate(*names)
    ros_nodes.wait_for(lambda: laboratory.period > ENDS, what='the end')
    ros_nodes.call(coordinator.end)
    return laboratory


def test_force_guides_the_robot_until_the_sensor_falls_silent(ros_nodes: Any) -> None:
    found = run(ros_nodes, depth=-0.1, sensor=True)
    control = ForceControl(SETUP.control, DT)
    silent = STOPS + round(SETUP.control.timeout / DT)
    periods = [period for period, _ in found.twists]
    assert periods[0] == HANDED_OVER + 1
    assert periods == list(range(HANDED_OVER + 1, periods[-1] + 1))
    assert silent <= periods[-1] + 1 <= silent + 2
    # The broken sample is left out: the one before it holds.
    expected = [control.step(np.array([0.0, 0.0, FORCE]), LOAD, SPEED) for _ in periods]
    np.testing.assert_allclose([twist for _, twist in found.twists], expected, atol=1e-12)
    reasons = [reason for _, reason in found.problems]
    assert reasons == ['none', 'no force was measured for 0.2 s', 'none']
    assert found.problems[2][0] >= TAKEN_BACK


def test_the_soil_is_measured_and_presses_back(ros_nodes: Any) -> None:
    found = run(ros_nodes, depth=0.01, sensor=False)
    step = SETUP.contact().of_robot(ROBOT, standing(0.01))
    np.testing.assert_allclose(found.wrenches[-1], step.wrench, atol=1e-9)
    load = SETUP.contact().model.standing(0.01).load
    reasons = [reason for _, reason in found.problems]
    assert reasons[0] == 'none'
    assert reasons[1].startswith(f'contact that was not planned: the force on the tool is {load:.1f} N; ')
