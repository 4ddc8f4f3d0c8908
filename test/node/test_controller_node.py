"""controller_node and drive_node together, over real topics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from trajectory_msgs.msg import JointTrajectory

from bench import Bench
from robots_controller.nodes.controller_node import ControllerNode
from robots_core.errors import InvalidInputError
from robots_core.ros.qos import SENSOR, STATE

from .controller_bench import AWAY, HOME, NAMES, OPTIONS, ControllerBench


@pytest.fixture
def bench(ros_nodes: Any) -> ControllerBench:
    return ControllerBench(ros_nodes)


def test_follows_a_trajectory_and_reports_when_the_robot_stands_there(bench: ControllerBench) -> None:
    sent = bench.send(HOME, AWAY)
    result = bench.result()
    assert result.id == sent
    assert result.ok, result.message
    assert float(result.details['planned_duration']) == 1.0
    np.testing.assert_allclose(bench.positions[-1], AWAY, atol=1e-5)  # goal_tolerance
    np.testing.assert_allclose(bench.references[-1], AWAY, atol=1e-12)
    bench.wait(lambda: bench.progress[-1] == 1.0, 'progress 1')


def test_matches_joints_by_name_not_by_order(bench: ControllerBench) -> None:
    order = [3, 1, 0, 5, 2, 4]
    bench.send(HOME[order], AWAY[order], names=[NAMES[i] for i in order])
    assert bench.result().ok
    np.testing.assert_allclose(bench.references[-1], AWAY, atol=1e-12)


def test_pause_stands_on_the_path_and_resume_goes_on(bench: ControllerBench) -> None:
    bench.send_slowly(AWAY)
    bench.ask('pause')
    bench.until_standing()
    part = (bench.references[-1] - HOME) / (AWAY - HOME)
    assert 0.0 < part[0] < 1.0
    np.testing.assert_allclose(part, part[0], atol=1e-9)  # a straight line in joint space
    bench.ask('resume')
    bench.override(1.0)
    assert bench.result().ok


def test_an_empty_trajectory_cancels(bench: ControllerBench) -> None:
    bench.send_slowly(AWAY)
    bench.trajectories.publish(JointTrajectory(joint_names=NAMES))
    assert bench.result().message == 'canceled by an empty joint_trajectory'


@pytest.mark.parametrize('value', [1.5, -0.1, float('nan')])
def test_an_override_outside_its_range_is_refused_and_named(bench: ControllerBench, value: float) -> None:
    bench.publish('override', Float64(data=value), STATE)
    status = bench.until_health(DiagnosticStatus.WARN, 'must be in [0, 1]')
    assert status.name == '/controller_node'
    bench.send(HOME, AWAY)
    assert bench.result().ok


def test_says_what_is_wrong_with_a_trajectory(bench: ControllerBench) -> None:
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


def driver_of(nodes: Any, qos: QoSProfile, state: JointState) -> tuple[Bench, ControllerNode]:
    """A controller whose only feedback is one state, repeated by a driver with its own quality of service."""
    bench = Bench(nodes, 'robot')
    controller = bench.start_node(ControllerNode, **OPTIONS)
    publisher = bench.publisher('joint_states', JointState, qos)
    bench.peer.create_timer(0.02, lambda: publisher.publish(state))
    return bench, controller


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
    bench, controller = driver_of(ros_nodes, STATE, JointState(name=names, position=positions))
    bench.until_health(DiagnosticStatus.WARN, reason)
    assert controller._controller.reference is None


@pytest.mark.parametrize('qos', [STATE, SENSOR, QoSProfile(depth=10)], ids=['state', 'sensor', 'default'])
def test_takes_feedback_of_every_quality_of_service(ros_nodes: Any, qos: QoSProfile) -> None:
    _, controller = driver_of(ros_nodes, qos, JointState(name=NAMES, position=AWAY.tolist()))
    ros_nodes.wait_for(lambda: controller._controller.reference is not None)
    np.testing.assert_array_equal(controller._controller.reference[0], AWAY)


def test_drives_with_motors_and_masses_come_to_the_target(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes, level='rigid_body')
    bench.send(HOME, AWAY)
    result = bench.result()
    assert result.ok, result.message
    # The feedback behind the result may still be on its way to the test; 1e-5 is the goal_tolerance.
    bench.wait(lambda: np.abs(bench.positions[-1] - AWAY).max() <= 1e-5, 'the target in joint_states')


@pytest.mark.parametrize('mode', ['T1', 'T2'])
def test_beside_a_person_nothing_becomes_faster_under_way(ros_nodes: Any, mode: str) -> None:
    bench = ControllerBench(ros_nodes, operating_mode=mode)
    bench.set_parameters(bench.controller, tool_speed_limit=0.1)
    bench.send(HOME, AWAY)  # held on its path, as nobody holds run
    bench.wait(lambda: bench.controller.moving, 'a motion')
    reason = f'tool_speed_limit may change only while the robot stands in operating mode {mode}'
    with pytest.raises(InvalidInputError, match=reason):
        bench.set_parameters(bench.controller, tool_speed_limit=0.0)
    bench.trajectories.publish(JointTrajectory())
    assert not bench.result().ok
    bench.wait(lambda: not bench.controller.moving, 'a standing robot')
    bench.set_parameters(bench.controller, tool_speed_limit=0.0)


def test_in_production_the_tool_speed_limit_changes_under_way(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes)
    bench.send_slowly(AWAY)
    bench.set_parameters(bench.controller, tool_speed_limit=0.1)
    assert bench.controller.moving
