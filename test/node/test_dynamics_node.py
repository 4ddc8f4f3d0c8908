"""dynamics_node: a motion in, torques, mass matrix and wrenches out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Transform, Twist, Vector3, WrenchStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, Header
from trajectory_msgs.msg import (
    JointTrajectory,
    JointTrajectoryPoint,
    MultiDOFJointTrajectory,
    MultiDOFJointTrajectoryPoint,
)

from bench import Bench
from robots_core import Pose, load_robot_model
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.free_floating_dynamics import FreeFloatingDynamics
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.nodes.dynamics_node import DynamicsNode
from robots_core.ros.messages import diagnostic_status, doubles
from robots_core.ros.qos import STATE

NAME = 'kuka_kr210_r2700'
ROBOT = load_robot_model(NAME)
NAMES = list(ROBOT.axes_data.names)
Q = np.array(ROBOT.home) + 0.1
SPEED = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
PUSH = np.array([0.5, 0.4, -0.3, 0.2, 0.1, 0.6])
STILL = np.zeros(6)


class DynamicsBench(Bench):
    """The node under test, fed and listened to by another."""

    def __init__(self, runner: Any, **parameters: Any) -> None:
        super().__init__(runner)
        for topic, kind in (
            ('joint_torques', JointState),
            ('bias_torques', JointState),
            ('mass_matrix', Float64MultiArray),
            ('tcp_wrench', WrenchStamped),
            ('base_wrench', WrenchStamped),
        ):
            self.collect(topic, kind)
        self.node = self.start_node(DynamicsNode, **{'robot_model': NAME, 'rate': 200.0, **parameters})

    def send(
        self, q: np.ndarray, q_dot: np.ndarray = STILL, tau: np.ndarray | None = None, at: float = 0.0
    ) -> Any:
        names = list(self.node.robot.axes_data.names)
        state = JointState(name=names[::-1], position=doubles(q[::-1]), velocity=doubles(q_dot[::-1]))
        if tau is not None:
            state.effort = doubles(tau[::-1])
        state.header.stamp.sec, state.header.stamp.nanosec = 100 + int(at), round(1e9 * (at % 1.0))
        self.publish('joint_states', state, STATE)
        return state.header.stamp

    def move_base(self, base: BaseMotion) -> None:
        point = base_point(
            velocities=[Twist(angular=vector(base.angular_velocity))],
            accelerations=[
                Twist(linear=vector(base.acceleration), angular=vector(base.angular_acceleration))
            ],
        )
        o = point.transforms[0].rotation
        o.x, o.y, o.z, o.w = Pose(np.zeros(3), base.T).quaternion().tolist()
        self.publish('base_motion', MultiDOFJointTrajectory(joint_names=['base'], points=[point]), STATE)

    def answer(self, topic: str, stamp: Any) -> Any:
        return self.wait(
            lambda: next((m for m in self.collected(topic) if m.header.stamp == stamp), None), topic
        )


def base_point(**motion: Any) -> MultiDOFJointTrajectoryPoint:
    return MultiDOFJointTrajectoryPoint(transforms=[Transform()], **motion)


def vector(values: np.ndarray) -> Vector3:
    x, y, z = values.tolist()
    return Vector3(x=x, y=y, z=z)


def wrench_of(message: WrenchStamped) -> np.ndarray:
    assert message.header.frame_id == 'base'
    force, torque = message.wrench.force, message.wrench.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


def close(mine: Any, expected: np.ndarray) -> None:
    np.testing.assert_allclose(mine, expected, rtol=0.0, atol=1e-9 * (1.0 + np.abs(expected).max()))


def test_torques_and_mass_matrix_of_joint_states(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes)
    stamp = bench.send(Q, SPEED)
    tau, M, tau_aux = NumericalDynamics(ROBOT).rigid_dynamics(Q, SPEED, STILL)
    message = bench.answer('joint_torques', stamp)
    assert list(message.name) == NAMES
    close(message.effort, tau)
    close(bench.answer('bias_torques', stamp).effort, tau_aux)
    (matrix,) = bench.wait(lambda: bench.collected('mass_matrix'), 'mass_matrix')
    rows, columns = matrix.layout.dim
    assert (rows.label, rows.size, rows.stride) == ('torque', 6, 36)
    assert (columns.label, columns.size, columns.stride) == ('acceleration', 6, 6)
    close(np.reshape(matrix.data, (rows.size, columns.size)), M)
    pushed = -NumericalDynamics(ROBOT).base_wrench(Q, SPEED, STILL)
    close(wrench_of(bench.answer('base_wrench', stamp)), pushed)
    assert not bench.collected('tcp_wrench')


def test_accelerations_are_estimated_from_velocities(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes, filter_time=0.0)
    bench.answer('joint_torques', bench.send(Q, SPEED, at=0.0))
    stamp = bench.send(Q, SPEED + 0.01 * PUSH, at=0.01)
    expected = NumericalDynamics(ROBOT).torques(Q, SPEED + 0.01 * PUSH, PUSH)
    # A stamp is good to 1 ns of the 10 ms.
    np.testing.assert_allclose(bench.answer('joint_torques', stamp).effort, expected, rtol=1e-6, atol=1e-3)


def test_references_bring_their_accelerations(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes, source='joint_reference')
    point = JointTrajectoryPoint(positions=doubles(Q), velocities=doubles(SPEED), accelerations=doubles(PUSH))
    message = JointTrajectory(joint_names=NAMES, points=[point])
    message.header.stamp.sec = 7
    bench.publish('joint_reference', message, STATE)
    expected = NumericalDynamics(ROBOT).torques(Q, SPEED, PUSH)
    close(bench.answer('joint_torques', message.header.stamp).effort, expected)


def test_payload_and_base_are_parameters(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes, payload=[50.0, 0.1, 0.0, 0.2])
    base = BaseMotion.ceiling()
    bench.set_parameters(
        bench.node,
        payload=[80.0, 0.0, 0.0, 0.2, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
        base_orientation=[1.0, 0.0, 0.0, 0.0],
    )
    load = Payload(80.0, np.array([0.0, 0.0, 0.2]), np.eye(3))
    expected = NumericalDynamics(ROBOT, payload=load, base=base).torques(Q, SPEED, STILL)
    close(bench.answer('joint_torques', bench.send(Q, SPEED)).effort, expected)


def test_the_payload_of_the_program_counts(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes)
    bench.publisher('motion_settings', DiagnosticStatus, STATE)
    values = {'payload': '[80.0, 0.0, 0.0, 0.2]'}
    bench.publish('motion_settings', diagnostic_status('motion settings', '', **values))
    load = Payload(80.0, np.array([0.0, 0.0, 0.2]))
    expected = NumericalDynamics(ROBOT, payload=load).torques(Q, SPEED, STILL)

    # Two topics have no order: the first joints may come before the payload.
    for second in range(100):
        effort = bench.answer('joint_torques', bench.send(Q, SPEED, at=float(second))).effort
        if abs(effort[1] - expected[1]) < 1.0:
            break
    close(effort, expected)


def test_a_moving_base_comes_on_a_topic(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes)
    base = BaseMotion(BaseMotion.wall().T, [0.5, 1.0, -2.0], [0.3, -0.2, 0.4], [1.0, 2.0, -1.5])
    dynamics = NumericalDynamics(ROBOT, base=base)
    torques, wrench = dynamics.torques(Q, SPEED, STILL), dynamics.base_wrench(Q, SPEED, STILL)

    # Two topics have no order: the first joints may come before the base's motion.
    for second in range(100):
        bench.move_base(base)
        stamp = bench.send(Q, SPEED, at=float(second))
        effort = bench.answer('joint_torques', stamp).effort
        if np.allclose(effort, torques):
            break
    close(effort, torques)
    close(wrench_of(bench.answer('base_wrench', stamp)), -wrench)


def test_the_arm_pushes_a_base_that_nothing_holds(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes, robot_model='debris_arm?gravity=0,0,0', free_floating=True)
    robot = load_robot_model('debris_arm?gravity=0,0,0')
    q, q_dot, still = np.array(robot.home), np.array([0.2, -0.1, 0.3]), np.zeros(3)
    stamp = bench.send(q, q_dot)
    dynamics = FreeFloatingDynamics(robot)
    close(bench.answer('joint_torques', stamp).effort, dynamics.torques(q, q_dot, still))
    close(wrench_of(bench.answer('base_wrench', stamp)), -dynamics.base_wrench(q, q_dot, still))


@pytest.mark.parametrize(
    ('change', 'reason'),
    [
        ({'header': Header(frame_id='moon')}, "frame 'moon'; it must be 'world'"),
        ({'points': []}, 'one point with one transform'),
        (
            {'points': [MultiDOFJointTrajectoryPoint(transforms=[Transform()], velocities=[Twist()] * 2)]},
            '2 velo',
        ),
    ],
)
def test_bad_motions_of_the_base_are_named(ros_nodes: Any, change: dict[str, Any], reason: str):
    bench = DynamicsBench(ros_nodes)
    bench.publish('base_motion', MultiDOFJointTrajectory(**change), STATE)
    bench.until_health(DiagnosticStatus.WARN, reason)


def test_the_wrench_at_the_tool_is_estimated_from_the_drives(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes)
    wrench = np.array([100.0, -50.0, 200.0, 10.0, 5.0, -20.0])
    tau = NumericalDynamics(ROBOT).bias_torques(Q, STILL) - ROBOT.jacobian(Q).T @ wrench
    stamp = bench.send(Q, STILL, tau)
    np.testing.assert_allclose(wrench_of(bench.answer('tcp_wrench', stamp)), wrench, atol=1e-6)


def test_a_torque_past_its_limit_is_reported_and_so_is_its_end(ros_nodes: Any):
    bench = DynamicsBench(ros_nodes)
    tau = np.zeros(6)
    tau[3] = 1.5 * ROBOT.axes_data.effort[3]
    bench.send(Q, STILL, tau)
    status = bench.until_health(DiagnosticStatus.WARN, f'torque of {NAMES[3]} is past its limit')
    values = {pair.key: pair.value for pair in status.values}
    assert float(values['torque']) == pytest.approx(tau[3])
    bench.health.clear()
    bench.send(Q, STILL, np.zeros(6), at=1.0)
    bench.until_health(DiagnosticStatus.OK, 'ready')


@pytest.mark.parametrize(
    ('change', 'reason'),
    [
        ({'name': NAMES[1:], 'position': [0.0] * 5}, 'lacks joint A1'),
        ({'position': [0.0] * 5 + [float('nan')]}, 'positions'),
        ({'velocity': [0.0] * 5}, '5 velocities for 6 joints'),
        ({'position': []}, 'no positions'),
    ],
)
def test_bad_joint_states_are_named(ros_nodes: Any, change: dict[str, Any], reason: str):
    bench = DynamicsBench(ros_nodes)
    bench.publish('joint_states', JointState(**({'name': NAMES, 'position': [0.0] * 6} | change)), STATE)
    bench.until_health(DiagnosticStatus.WARN, reason)
    assert not bench.collected('joint_torques')
    close(
        bench.answer('joint_torques', bench.send(Q)).effort, NumericalDynamics(ROBOT).torques(Q, STILL, STILL)
    )


@pytest.mark.parametrize(
    ('parameters', 'reason'),
    [
        ({'source': 'guesses'}, "source 'guesses' is unknown"),
        ({'base_orientation': [0.0, 0.0, 0.0, 0.0]}, 'length 0'),
        ({'payload': [1.0, 2.0]}, 'payload has 2 numbers'),
    ],
)
def test_bad_parameters_end_the_start(ros_nodes: Any, parameters: dict[str, Any], reason: str):
    with pytest.raises(InvalidInputError, match=reason):
        DynamicsBench(ros_nodes, **parameters)
