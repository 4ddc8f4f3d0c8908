"""controller_node and drive_node together, over real topics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import doubles, motion_result_from_message, stamp_id
from robots_core.ros.qos import COMMAND, PLANNER_ALIVE, SENSOR, STATE

ROBOT = load_robot_model('kuka_kr210_r2700')
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)
AWAY = HOME + np.array([0.2, 0.1, -0.1, 0.3, 0.2, 0.1])
FAST_DRIVES = [Parameter('bandwidth', value=[40.0])]
MANY = QoSProfile(depth=1000)


class Bench:
    """A controller with its drive, and somebody who sends trajectories."""

    def __init__(self, nodes: Any, *drives: Parameter) -> None:
        self.nodes = nodes
        options: dict[str, Any] = {'context': nodes.context}
        # One process runs the test too, which no thread may push aside.
        robot = Parameter('robot_model', value='kuka_kr210_r2700')
        ordinary = Parameter('realtime_priority', value=0)
        self.drive = DriveNode(**options, parameter_overrides=[robot, ordinary, *(drives or FAST_DRIVES)])
        self.controller = ControllerNode(**options, parameter_overrides=[robot, ordinary])
        node = self.node = nodes.create_node('planner')
        self.references: list[np.ndarray] = []
        self.newest_reference = 0.0  # s
        self.results: list[MotionResult] = []
        self.progress: list[float] = []
        self.health: dict[str, tuple[bytes, str]] = {}
        self.told: list[str] = []  # in all diagnostics
        self.positions: list[np.ndarray] = []
        self.newest_state = 0.0  # s
        self.trajectories = node.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
        self.override = node.create_publisher(Float64, 'override', STATE)
        node.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, MANY)
        node.create_subscription(
            DiagnosticStatus,
            'motion_result',
            lambda m: self.results.append(motion_result_from_message(m)),
            COMMAND,
        )
        node.create_subscription(Float64, 'motion_progress', lambda m: self.progress.append(m.data), MANY)
        node.create_subscription(JointState, 'joint_states', self._on_joint_states, MANY)
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, MANY)
        nodes.add(self.drive)
        nodes.add(self.controller)
        self.wait(lambda: self.references and self.trajectories.get_subscription_count(), 'first reference')

    def _on_reference(self, message: JointTrajectory) -> None:
        self.references.append(np.array(message.points[0].positions))
        self.newest_reference = float(stamp_id(message.header.stamp))

    def _on_joint_states(self, message: JointState) -> None:
        self.positions.append(np.array(message.position))
        self.newest_state = float(stamp_id(message.header.stamp))

    def _on_health(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.health[status.name] = (status.level, status.message)
            self.told.append(f'{status.name}: {status.message}')

    def wait(self, condition: Callable[[], Any], what: str) -> None:
        self.nodes.wait_for(condition, what=what)

    def send(
        self, start: np.ndarray, goal: np.ndarray, duration: float = 1.0, names: list[str] | None = None
    ) -> str:
        """Send a minimum-jerk motion; returns its id."""
        zero = doubles(np.zeros(start.size))
        message = JointTrajectory(joint_names=names or NAMES)
        message.header.stamp = self.node.get_clock().now().to_msg()
        for time, q in ((0.0, start), (duration, goal)):
            point = JointTrajectoryPoint(positions=doubles(q), velocities=zero, accelerations=zero)
            point.time_from_start.sec, point.time_from_start.nanosec = int(time), int(1e9 * (time % 1))
            message.points.append(point)
        self.trajectories.publish(message)
        return stamp_id(message.header.stamp)

    def result(self) -> MotionResult:
        self.wait(lambda: self.results, 'motion_result')
        # On a busy machine the last references and states come after it.
        now = 1e-9 * self.node.get_clock().now().nanoseconds
        self.wait(lambda: self.newest_reference >= now, 'the references until now')
        if self.drive._loop.alive:
            self.wait(lambda: self.newest_state >= now, 'the states until now')
        return self.results.pop(0)

    def call(self, service: str) -> None:
        client = self.node.create_client(Trigger, f'controller_node/{service}')
        self.wait(client.service_is_ready, service)
        future = client.call_async(Trigger.Request())
        self.wait(future.done, service)
        assert future.result().success

    def until_moving(self) -> None:
        self.wait(lambda: 0.0 < (self.progress or [0.0])[-1] < 1.0, 'a moving robot')

    def until_standing(self) -> None:
        """The last 50 references, 0.2 s of them, are the same."""
        count = len(self.references)
        self.wait(
            lambda: len(self.references) > count + 50 and np.ptp(self.references[-50:], axis=0).max() == 0.0,
            'a standing robot',
        )


@pytest.fixture
def bench(ros_nodes: Any) -> Bench:
    return Bench(ros_nodes)


def test_follows_a_trajectory_and_tells_when_the_robot_stands_there(bench: Bench) -> None:
    sent = bench.send(HOME, AWAY)
    result = bench.result()
    assert result.id == sent
    assert result.ok, result.message
    assert float(result.details['planned_duration']) == 1.0
    np.testing.assert_allclose(bench.positions[-1], AWAY, atol=1e-5)  # goal_tolerance
    np.testing.assert_allclose(bench.references[-1], AWAY, atol=1e-12)
    bench.wait(lambda: bench.progress[-1] == 1.0, 'progress 1')
    assert 0.0 in bench.progress
    assert np.all(np.diff(bench.progress[bench.progress.index(0.0) :]) >= 0.0)


def test_matches_joints_by_name_not_by_order(bench: Bench) -> None:
    order = [3, 1, 0, 5, 2, 4]
    bench.send(HOME[order], AWAY[order], names=[NAMES[i] for i in order])
    assert bench.result().ok
    np.testing.assert_allclose(bench.references[-1], AWAY, atol=1e-12)


def test_pause_stands_on_the_path_and_resume_goes_on(bench: Bench) -> None:
    bench.send(HOME, AWAY)
    bench.until_moving()
    bench.call('pause')
    bench.until_standing()
    part = (bench.references[-1] - HOME) / (AWAY - HOME)
    assert 0.0 < part[0] < 1.0
    np.testing.assert_allclose(part, part[0], atol=1e-9)  # a straight line in joint space
    bench.call('resume')
    assert bench.result().ok


def test_stop_gives_the_motion_up_and_the_next_one_runs(bench: Bench) -> None:
    bench.send(HOME, AWAY)
    bench.until_moving()
    bench.call('stop')
    result = bench.result()
    assert not result.ok
    assert result.message == 'stopped by ~/stop'
    bench.until_standing()
    bench.send(bench.references[-1], HOME)
    assert bench.result().ok


def test_an_empty_trajectory_stops(bench: Bench) -> None:
    bench.send(HOME, AWAY)
    bench.until_moving()
    bench.trajectories.publish(JointTrajectory(joint_names=NAMES))
    assert bench.result().message == 'stopped by an empty joint_trajectory'


def test_half_the_override_takes_twice_the_time(bench: Bench) -> None:
    bench.override.publish(Float64(data=0.5))
    bench.wait(lambda: bench.controller._controller.override == 0.5, 'override')
    bench.send(HOME, AWAY)
    assert bench.result().ok
    moves = np.diff(bench.references, axis=0).any(axis=1)
    # 2 s of path, then smoothing, which the override does not touch; late periods are of the same length.
    assert 1.9 <= moves.sum() / 250.0 <= 2.1


@pytest.mark.parametrize('value', [1.5, -0.1, float('nan')])
def test_an_override_outside_its_range_is_refused_and_named(bench: Bench, value: float) -> None:
    bench.override.publish(Float64(data=value))
    bench.wait(
        lambda: any(
            text.startswith('/controller_node: ') and 'must be in [0, 1]' in text for text in bench.told
        ),
        'a diagnostic',
    )
    bench.send(HOME, AWAY)
    assert bench.result().ok


def test_lost_feedback_brakes_on_the_path(bench: Bench) -> None:
    bench.send(HOME, AWAY)
    bench.until_moving()
    bench.drive._loop.stop()
    result = bench.result()
    assert not result.ok
    assert 'no feedback for 0.5 s' in result.message
    part = (bench.references[-1] - HOME) / (AWAY - HOME)
    np.testing.assert_allclose(part, part[0], atol=1e-9)
    bench.wait(lambda: bench.health['/controller_node'][0] == DiagnosticStatus.ERROR, 'an error')


def test_a_lost_planner_brakes_on_the_path(bench: Bench, ros_domain: int) -> None:
    # Liveliness is a matter between participants of the middleware, and a context is one.
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros_domain)
    planner = Node('planning_node', context=context)
    planner.create_publisher(Bool, 'finished', PLANNER_ALIVE)
    bench.wait(lambda: bench.controller._planner_seen, 'a planner that is alive')
    bench.send(HOME, AWAY)
    bench.until_moving()
    planner.destroy_node()
    context.try_shutdown()
    result = bench.result()
    assert not result.ok
    assert result.message.startswith('planning_node is gone')


def test_says_what_is_wrong_with_a_trajectory(bench: Bench) -> None:
    too_far = HOME.copy()
    too_far[1] = 0.5
    for start, goal, duration, names, message in (
        (HOME + 0.1, AWAY, 1.0, NAMES, 'plan from the current joint_reference'),
        (HOME, AWAY, 0.1, NAMES, 'breaks a limit'),
        (HOME, too_far, 3.0, NAMES, 'A2'),
        (HOME, np.full(6, np.nan), 1.0, NAMES, 'not finite'),
        (HOME, AWAY, 1.0, ['x', *NAMES[1:]], 'lacks joint A1'),
    ):
        sent = bench.send(start, goal, duration, list(names))
        result = bench.result()
        assert result.id == sent
        assert not result.ok
        assert message in result.message
    np.testing.assert_array_equal(bench.references[-1], HOME)
    bench.send(HOME, AWAY)
    assert bench.result().ok


def driver_of(nodes: Any, qos: QoSProfile, state: JointState) -> ControllerNode:
    """A controller whose only feedback is one state, repeated by a driver with its own quality of service."""
    robot = Parameter('robot_model', value='kuka_kr210_r2700')
    ordinary = Parameter('realtime_priority', value=0)
    controller: ControllerNode = nodes.add(
        ControllerNode(context=nodes.context, parameter_overrides=[robot, ordinary])
    )
    node = nodes.create_node('robot')
    publisher = node.create_publisher(JointState, 'joint_states', qos)
    node.create_timer(0.02, lambda: publisher.publish(state))
    return controller


@pytest.mark.parametrize(
    ('names', 'positions', 'reason'),
    [
        (NAMES[:5], [0.0] * 5, 'lacks joint A6'),
        (NAMES, [0.0, float('nan'), *[0.0] * 4], 'joint_states[1] is nan'),
    ],
)
def test_refuses_joint_states_that_do_not_say_where_the_robot_is(
    ros_nodes: Any, names: list[str], positions: list[float], reason: str
) -> None:
    controller = driver_of(ros_nodes, STATE, JointState(name=names, position=positions))
    messages: list[str] = []
    ros_nodes.create_node('observer').create_subscription(
        DiagnosticArray, '/diagnostics', lambda m: messages.extend(s.message for s in m.status), MANY
    )
    ros_nodes.wait_for(lambda: any(reason in message for message in messages))
    assert controller._controller.reference is None


@pytest.mark.parametrize('qos', [STATE, SENSOR, QoSProfile(depth=10)], ids=['state', 'sensor', 'default'])
def test_hears_drivers_of_every_quality_of_service(ros_nodes: Any, qos: QoSProfile) -> None:
    controller = driver_of(ros_nodes, qos, JointState(name=NAMES, position=AWAY.tolist()))
    ros_nodes.wait_for(lambda: controller._controller.reference is not None)
    np.testing.assert_array_equal(controller._controller.reference[0], AWAY)


def test_drives_with_motors_and_masses_come_to_the_target(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes, Parameter('level', value='rigid_body'))
    bench.send(HOME, AWAY)
    result = bench.result()
    assert result.ok, result.message
    # The feedback behind the result may still be on its way to the test; 1e-5 is the goal_tolerance.
    bench.wait(lambda: np.abs(bench.positions[-1] - AWAY).max() <= 1e-5, 'the target in joint_states')


@pytest.mark.parametrize(
    ('fault', 'axes', 'reason'),
    [
        ('fault_stopped', ['A2'], 'does the drive follow?'),
        ('fault_frozen', ['A3'], 'does the drive follow?'),
        ('fault_lost', ['A5'], 'no feedback for 0.5 s'),
    ],
)
def test_a_fault_of_the_drives_stops_the_motion(
    bench: Bench, fault: str, axes: list[str], reason: str
) -> None:
    far = HOME + np.array([0.0, 0.6, -0.6, 0.0, 0.6, 0.0])
    bench.send(HOME, far, duration=2.0)
    bench.until_moving()
    (accepted,) = bench.drive.set_parameters([Parameter(fault, value=axes)])
    assert accepted.successful, accepted.reason
    result = bench.result()
    assert not result.ok
    assert reason in result.message
    bench.until_standing()
