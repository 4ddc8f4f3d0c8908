"""drive_node: joint_reference in, joint_states out, at every level and with every fault."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64MultiArray, String, UInt8MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from robots_core import load_robot_model
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.drives.supervised_drives import DriveState
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_status, doubles, stamp_id
from robots_core.ros.qos import STATE
from robots_core.ros.streams.polled_subscription import Arrivals, PolledSubscription

ORBIT = Path(__file__).parents[2] / 'programs' / 'debris_removal' / 'orbit.yaml'
NAME = 'kuka_kr210_r2700'
ROBOT = load_robot_model(NAME)
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)


class DriveBench(Bench):
    """A drive node; the test stands in for the controller."""

    def __init__(self, runner: Any, **parameters: Any) -> None:
        super().__init__(runner)
        self.states = self.collect('joint_states', JointState)
        # One process runs the test too, which no thread may push aside.
        self.drive = self.start_node(DriveNode, robot_model=NAME, realtime_priority=0, **parameters)
        self._reference: JointTrajectory | None = None
        references = self.publisher('joint_reference', JointTrajectory, STATE)
        self.peer.create_timer(0.01, lambda: self._reference and references.publish(self._reference))
        self.wait(lambda: self.states, 'joint_states')

    def refer(
        self,
        q: np.ndarray,
        q_dot: np.ndarray | None = None,
        names: list[str] | None = None,
        *,
        due: float = 0.0,
        once: bool = False,
    ) -> None:
        """Send a reference again and again, due at a time of the test's own, s."""
        point = JointTrajectoryPoint(positions=doubles(q))
        if q_dot is not None:
            point.velocities = doubles(q_dot)
        message = JointTrajectory(joint_names=names or NAMES, points=[point])
        message.header.stamp = Time(sec=1 + int(due), nanosec=int(1e9 * (due % 1.0)))
        self._reference = None if once else message
        self.publish('joint_reference', message)

    def until_following(self) -> None:
        """Open the brakes: a reference where the robot stands."""
        self.refer(HOME)
        self.wait(lambda: self.drive._supervised.state is DriveState.FOLLOWING, 'open brakes')

    def set(self, **values: Any) -> None:
        self.set_parameters(self.drive, **values)

    def until_at(self, q: np.ndarray, tolerance: float = 1e-6) -> JointState:
        def there() -> bool:
            state = self.states[-1]
            return len(state.name) == q.size and np.abs(np.array(state.position) - q).max() <= tolerance

        self.wait(there, f'the robot at {q}')
        return self.states[-1]

    def next_states(self, count: int) -> list[JointState]:
        """States sent from now on, except for one that may be under way; older ones may still come in."""
        now = 1e-9 * self.drive.get_clock().now().nanoseconds

        def sent() -> list[JointState]:
            newer = [state for state in self.states if float(stamp_id(state.header.stamp)) >= now]
            return newer[1 : 1 + count]

        self.wait(lambda: len(sent()) == count, f'{count} states')
        return sent()


def test_a_base_floats_live_and_its_momentum_stays(ros_nodes: Any):
    robot = load_robot_model('debris_arm?gravity=0,0,0')
    home = np.array(robot.home)
    bench = Bench(ros_nodes)
    states = bench.collect('joint_states', JointState)
    momenta, poses = bench.collect('momentum', Float64MultiArray), bench.collect('base_pose', PoseStamped)
    inputs = bench.collect('digital_inputs', UInt8MultiArray)
    seen = bench.collect('reference_pose', PoseStamped)
    options = {'realtime_priority': 0, 'level': 'ideal', 'orbit': str(ORBIT)}
    drive = bench.start_node(DriveNode, robot_model='debris_arm?gravity=0,0,0', **options)
    bench.wait(lambda: states and poses, 'the robot and its base')
    bench.publisher('guide', String, STATE).publish(String(data='SENSOR'))
    target = home + np.array([0.003, 0.0, 0.0])  # so near that its brakes open at once
    point = JointTrajectoryPoint(positions=doubles(target), velocities=doubles(np.zeros(3)))
    reference = JointTrajectory(joint_names=list(robot.axes_data.names), points=[point])
    sent = bench.publisher('joint_reference', JointTrajectory, STATE)
    bench.peer.create_timer(0.01, lambda: sent.publish(reference))
    bench.wait(lambda: abs(states[-1].position[0] - target[0]) < 1e-6 and seen, 'the arm to move')
    count = len(poses)
    bench.wait(lambda: len(poses) > count and len(momenta) > count, 'a pose of after the motion')
    # The base has turned against the arm, and the camera has seen the ring meanwhile.
    assert poses[-1].pose.orientation.z < -1e-4
    assert len(states[-1].effort) == 3
    total = np.array([np.reshape(m.data, (3, 6)).sum(axis=0) for m in momenta])
    np.testing.assert_allclose(total, total[[0]].repeat(len(total), axis=0), atol=1e-9)
    assert bytes(inputs[-1].data) == b'\0\0\0'
    assert drive._drives.rendezvous is not None


@pytest.mark.parametrize('level', DRIVE_LEVELS)
def test_every_level_comes_to_its_reference(ros_nodes: Any, level: str):
    bench = DriveBench(ros_nodes, level=level)
    target = HOME + 0.01
    bench.refer(target[::-1], names=NAMES[::-1])
    state = bench.until_at(target)
    assert list(state.name) == NAMES
    assert len(state.velocity) == 6
    if drive_train(level, ROBOT, HOME, period=0.01).torque is not None:
        expected = NumericalDynamics(ROBOT).bias_torques(target, np.zeros(6))
        bench.wait(
            lambda: np.allclose(bench.states[-1].effort, expected, rtol=1e-2, atol=1.0),
            'the torques that hold the robot',
        )
    else:
        assert len(state.effort) == 0


def test_axes_that_have_stood_for_a_while_are_reported_seldom(ros_nodes: Any):
    bench = DriveBench(ros_nodes, rate=250.0, resting_rate=50.0)

    def steps() -> np.ndarray:
        stamps = [float(stamp_id(state.header.stamp)) for state in bench.states[-10:]]
        return np.diff(stamps)

    bench.until_following()
    bench.wait(lambda: len(steps()) == 9 and steps().min() > 0.0199, 'states of axes at rest')
    bench.refer(HOME + 0.3, np.full(6, 0.1))
    bench.wait(lambda: 0.0 < steps().min() < 0.0041, 'states of each period')


def test_drives_at_rest_sleep_until_a_reference_comes_and_report_when_it_has(ros_nodes: Any):
    bench = DriveBench(ros_nodes, rate=250.0, resting_rate=20.0, watchdog=60.0)
    bench.until_following()
    bench.wait(lambda: bench.drive._supervised.settled, 'drives that have settled')
    bench._reference = None
    rest = bench.drive._rest(0.2)
    bench.wait(lambda: rest.periods() > 5, 'a rest')
    assert rest.periods() < 0.2 / (5 * 0.004)
    count = len(bench.states)
    bench.refer(HOME, once=True)
    bench.wait(lambda: len(bench.states) > count, 'a report')
    bench.refer(HOME + 1e-4, once=True)
    bench.until_at(HOME + 1e-4)


def test_a_loop_waits_for_messages_that_it_polls(ros_nodes: Any):
    bench = Bench(ros_nodes)
    polled = PolledSubscription(bench.peer, Bool, 'drives_on')
    publisher = bench.publisher('drives_on', Bool, STATE)
    arrivals = Arrivals(bench.peer, [polled])
    assert not arrivals.wait(0.0)
    publisher.publish(Bool(data=True))
    assert arrivals.wait(60.0)
    assert arrivals.wait(60.0)  # it was not taken
    assert polled.take().data
    assert not arrivals.wait(0.0)


def test_the_payload_is_felt(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='rigid_body', payload=[100.0, 0.0, 0.0, 0.3])
    load = Payload(100.0, np.array([0.0, 0.0, 0.3]))
    expected = NumericalDynamics(ROBOT, payload=load).bias_torques(HOME, np.zeros(6))
    np.testing.assert_allclose(bench.states[-1].effort, expected, rtol=1e-6, atol=1e-6)
    assert abs(expected[1] - NumericalDynamics(ROBOT).bias_torques(HOME, np.zeros(6))[1]) > 500.0


def test_a_late_reference_is_extrapolated_for_a_while_and_then_held(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='ideal')
    bench.until_following()
    speed = 0.5 * 0.004 * ROBOT.axes_data.acceleration  # that the drives reach within a period
    bench.refer(HOME, speed, once=True)
    held = HOME + 5 * 0.004 * speed + 0.5 * 0.004 * speed  # five periods, and one in which they stop
    bench.until_at(held)
    bench.wait(lambda: not np.any(bench.states[-1].velocity), 'standstill')
    for state in bench.next_states(5):
        np.testing.assert_allclose(state.position, held, atol=1e-6)


@pytest.mark.parametrize('level', DRIVE_LEVELS)
def test_without_references_the_brakes_close_and_an_old_one_moves_nothing(ros_nodes: Any, level: str):
    bench = DriveBench(ros_nodes, level=level, watchdog=0.1)
    bench.until_following()
    bench.refer(HOME, once=True)
    bench.until_health(DiagnosticStatus.WARN, 'the references have ended')
    bench.refer(HOME + 0.74)
    bench.until_health(DiagnosticStatus.WARN, 'it is 0.74 rad from where A')
    np.testing.assert_allclose(bench.next_states(1)[0].position, HOME, atol=1e-6)
    bench.until_following()
    bench.until_health(DiagnosticStatus.OK, 'ready')


def test_drives_that_are_switched_off_brake_and_follow_nothing(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='ideal')
    bench.until_following()
    bench.publish('drives_on', Bool(data=False), STATE)
    bench.until_health(DiagnosticStatus.WARN, 'switched off')
    bench.refer(HOME + 0.005)
    for state in bench.next_states(5):
        np.testing.assert_array_equal(state.position, HOME)
    bench.publish('drives_on', Bool(data=True), STATE)
    bench.refer(HOME + 0.005)
    bench.until_at(HOME + 0.005)


def test_a_stopped_drive_stays_where_it_is(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='ideal')
    bench.until_following()
    bench.set(fault_stopped=[NAMES[2]])
    bench.next_states(2)
    bench.refer(HOME)
    bench.next_states(2)
    bench.refer(HOME + 0.1, due=0.1)
    expected = HOME + 0.1
    expected[2] = HOME[2]
    bench.until_at(expected)
    bench.set(fault_stopped=[''])
    bench.refer(HOME + 0.1, due=0.2)
    bench.until_at(HOME + 0.1)


def test_a_frozen_encoder_reports_what_it_saw_last(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='ideal')
    bench.until_following()
    bench.set(fault_frozen=[NAMES[0], NAMES[4]])
    bench.next_states(2)
    bench.refer(HOME + 0.1, due=0.1)
    expected = HOME + 0.1
    expected[[0, 4]] = HOME[[0, 4]]
    bench.until_at(expected)


def test_a_lost_joint_is_missing_in_joint_states(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='rigid_body')
    bench.set(fault_lost=[NAMES[1]])
    for state in bench.next_states(3):
        assert list(state.name) == NAMES[:1] + NAMES[2:]
        assert len(state.position) == len(state.velocity) == len(state.effort) == 5
    bench.set(fault_lost=[''])
    assert [list(state.name) for state in bench.next_states(2)] == [NAMES, NAMES]


def test_noise_is_reported(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='ideal')
    bench.set(fault_noise=0.01)
    spread = np.std([np.array(state.position) - HOME for state in bench.next_states(100)])
    assert spread == pytest.approx(0.01, rel=0.2)  # 600 samples: 3 % of standard deviation


@pytest.mark.parametrize(
    ('values', 'reason'),
    [
        ({'fault_stopped': ['elbow']}, "no axis is called 'elbow'"),
        ({'fault_noise': -0.1}, 'out of range'),
        ({'fault_noise': float('nan')}, 'out of range'),
    ],
)
def test_bad_faults_are_refused(ros_nodes: Any, values: dict[str, Any], reason: str):
    bench = DriveBench(ros_nodes)
    with pytest.raises(InvalidInputError, match=reason):
        bench.set(**values)


@pytest.mark.parametrize(
    ('parameters', 'reason'),
    [
        ({'level': 'perfect'}, "drive level 'perfect' is unknown"),
        ({'payload': [1.0]}, 'payload has 1 numbers; a payload is'),
        ({'payload': [-1.0, 0.0, 0.0, 0.0]}, 'mass = -1.0 kg'),
    ],
)
def test_bad_parameters_end_the_start(ros_nodes: Any, parameters: dict[str, Any], reason: str):
    with pytest.raises(InvalidInputError, match=reason):
        DriveBench(ros_nodes, **parameters)


@pytest.mark.parametrize('bad', [np.append(HOME[:5], np.nan), HOME + 100.0, HOME[:5]])
def test_a_bad_reference_is_refused_and_the_drives_stay(ros_nodes: Any, bad: np.ndarray):
    bench = DriveBench(ros_nodes, level='ideal')
    bench.refer(bad)
    bench.until_health(DiagnosticStatus.WARN, 'joint_reference')
    np.testing.assert_array_equal(bench.next_states(1)[0].position, HOME)
    bench.refer(HOME + 0.01)
    bench.until_at(HOME + 0.01)


def test_drives_carry_the_payload_of_the_motion_settings(ros_nodes: Any):
    bench = DriveBench(ros_nodes, level='rigid_body')
    bench.until_following()
    box = Payload(80.0, np.array([0.0, 0.0, 0.3]))
    efforts = {
        payload.mass: NumericalDynamics(ROBOT, payload=payload, rotors=False).bias_torques(HOME, np.zeros(6))
        for payload in (Payload(0.0), box)
    }
    bench.publisher('motion_settings', DiagnosticStatus, STATE)
    for mass in (80.0, 0.0):
        values = {'payload': f'[{mass}, 0.0, 0.0, 0.3]'}
        bench.publish('motion_settings', diagnostic_status('motion settings', '', **values))
        # A2 carries most of it; friction holds the rest.
        wanted = efforts[mass][1]
        bench.wait(lambda: abs(bench.states[-1].effort[1] - wanted) < 300.0, f'{wanted:.0f} N m')  # noqa: B023
