"""planning_node: blended commands, planned and sent as one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from rclpy.serialization import serialize_message

from robots_core import Pose
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.ros.joint_trajectories import SerializedTrajectory
from robots_core.ros.messages import diagnostic_values, motion_result_message, stamp_id
from robots_core.ros.qos import COMMAND
from robots_planning import verify
from robots_planning.commands.command_queue import WINDOW
from robots_planning.nodes.motion_messages import trajectory_from_message

from .planning_bench import ROBOT, PlanningBench


def blended(ros_nodes: Any, zone: float = 0.02) -> PlanningBench:
    bench = PlanningBench(ros_nodes, blend_zone=zone, joint_blend_zone=0.1)
    bench.stand(bench.robot.home)
    return bench


def steps(bench: PlanningBench, count: int) -> list[np.ndarray]:
    """Joint targets on a square of the first and the third axis."""
    corners = [(0.3, 0.0), (0.3, 0.3), (0.0, 0.3), (0.0, 0.0)]
    targets = []
    for number in range(count):
        target = bench.robot.home.copy()
        target[[0, 2]] += corners[number % 4]
        targets.append(target)
    return targets


def set_zones(bench: PlanningBench, zone: float) -> None:
    """As a program does, by the node's service."""
    client = bench.peer.create_client(SetParametersAtomically, 'planning_node/set_parameters_atomically')
    bench.wait(client.service_is_ready, 'the parameter service')
    parameters = [Parameter(name, value=zone) for name in ('blend_zone', 'joint_blend_zone')]
    future = client.call_async(
        SetParametersAtomically.Request(parameters=[parameter.to_parameter_msg() for parameter in parameters])
    )
    bench.wait(future.done, 'the zones are set')
    assert future.result().result.successful


def test_blended_commands_become_one_trajectory_of_the_last_one(ros_nodes: Any) -> None:
    bench = blended(ros_nodes)
    targets = steps(bench, 3)
    ids = [bench.command('ptpjoint_joint', target, 5 + number) for number, target in enumerate(targets)]
    bench.wait(lambda: all(bench.node.planner.holds(id_) for id_ in ids), 'all are held')
    plans = bench.collect('motion_plan', DiagnosticStatus, COMMAND, diagnostic_values)
    bench.wait(lambda: bench.peer.count_publishers('motion_plan'), 'the plans are heard')
    set_zones(bench, 0.0)
    trajectory = bench.planned()
    bench.wait(lambda: plans, 'the plan')
    ends = [float(plans[0][id_]) for id_ in ids]
    assert plans[0]['id'] == ids[-1]
    assert 0.0 < ends[0] < ends[1] < ends[2] == trajectory.duration
    assert [stamp_id(message.header.stamp) for message in bench.trajectories] == ids[-1:]
    np.testing.assert_allclose(trajectory.position[-1], targets[-1], atol=1e-9)
    report = verify(trajectory, bench.robot, torque=False)
    assert report.ok, report.describe()


def test_motions_that_were_passed_are_answered_with_the_last_one(ros_nodes: Any) -> None:
    bench = blended(ros_nodes)
    ids = [bench.command('ptpjoint_joint', target, 5 + k) for k, target in enumerate(steps(bench, 3))]
    bench.planned()
    bench.end(ids[-1])
    bench.wait(lambda: len(bench.results) == 3, 'a result for each')
    results = {result.id: result for result in bench.results}
    assert [results[id_].message for id_ in ids] == ['passed', 'passed', 'reached']
    assert all(result.ok for result in bench.results)
    bench.wait(lambda: bench.finished[-1], 'finished with the last of them')


def test_a_chain_that_was_canceled_reports_which_of_its_motions_were_passed(ros_nodes: Any) -> None:
    bench = blended(ros_nodes)
    ids = [bench.command('ptpjoint_joint', target, 5 + k) for k, target in enumerate(steps(bench, 3))]
    bench.planned()
    (motion,) = bench.node.planner.motions
    first, second, _ = motion.ends.values()
    between = 0.5 * (first + second) / motion.trajectory.duration
    progress = {'progress': str(between)}
    stopped = MotionResult(ids[-1], ok=False, message='canceled by ~/cancel', details=progress)
    bench.publish('motion_result', motion_result_message(stopped, ROBOT))
    bench.wait(lambda: len(bench.results) == 3, 'a result for each')
    results = {result.id: (result.ok, result.message) for result in bench.results}
    assert [results[id_] for id_ in ids] == [
        (True, 'passed'), (False, 'canceled by ~/cancel'), (False, 'canceled by ~/cancel')
    ]  # fmt: skip


def test_a_blended_command_that_nothing_follows_stops_at_its_target(ros_nodes: Any) -> None:
    bench = blended(ros_nodes)
    target = steps(bench, 1)[0]
    id_ = bench.command('ptpjoint_joint', target, 5)
    trajectory = bench.planned()  # its patience ends
    assert stamp_id(bench.trajectories[0].header.stamp) == id_
    np.testing.assert_allclose(trajectory.position[-1], target, atol=1e-9)


def test_a_command_that_stops_ends_the_chain_before_it(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes)
    bench.stand(bench.robot.home)
    set_zones(bench, 0.05)
    targets = steps(bench, 2)
    first = bench.command('ptpjoint_joint', targets[0], 5)
    bench.wait(lambda: bench.node.planner.holds(first), 'the first is held')
    set_zones(bench, 0.0)  # nothing that it could run through to is coming
    bench.planned()
    bench.command('ptpjoint_joint', targets[1], 6)
    bench.planned(2)
    assert [message.header.stamp.sec for message in bench.trajectories] == [5, 6]


def test_a_longer_chain_than_is_planned_at_once_goes_on_from_the_middle_of_the_plan(ros_nodes: Any) -> None:
    bench = blended(ros_nodes)
    plans = bench.collect('motion_plan', DiagnosticStatus, COMMAND, diagnostic_values)
    bench.wait(lambda: bench.peer.count_publishers('motion_plan'), 'the plans are heard')
    targets = enumerate(steps(bench, WINDOW + 3))
    ids = [bench.command('ptpjoint_joint', target, 5 + number) for number, target in targets]
    bench.wait(lambda: all(bench.node.planner.holds(id_) for id_ in ids), 'all are held')
    set_zones(bench, 0.0)
    bench.wait(lambda: len(bench.trajectories) == 2, 'two trajectories')
    first, second = bench.trajectories
    middle = WINDOW // 2
    assert [stamp_id(message.header.stamp) for message in (first, second)] == [ids[middle - 1], ids[-1]]
    bench.wait(lambda: len(plans) == 2, 'both plans')
    names = list(bench.robot.axes_data.names)
    (before, _), (after, join_time) = (
        trajectory_from_message(SerializedTrajectory(serialize_message(message)), names)
        for message in (first, second)
    )
    corner = before.duration + join_time
    assert [*plans[1]] == ['id', *ids[middle:]]
    assert float(plans[0][ids[middle - 1]]) == pytest.approx(corner, abs=1e-9)
    for one, other in zip(before.sample(corner), after.sample(0.0), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7)
    assert np.abs(after.velocity[0]).max() > 0.0


def test_a_chain_with_an_impossible_motion_is_done_up_to_it(ros_nodes: Any) -> None:
    bench = blended(ros_nodes)
    good = bench.command('ptpjoint_joint', steps(bench, 1)[0], 5)
    far = Pose(np.array([50.0, 0.0, 0.0]), np.eye(3))
    bad = bench.command('ptpcartesian', far, 6)
    after = bench.command('ptpjoint_joint', bench.robot.home, 7)
    assert 'cannot reach' in bench.refusal(bad).message
    assert f'given up with motion {bad} before it' in bench.refusal(after).message
    bench.planned()
    assert [stamp_id(message.header.stamp) for message in bench.trajectories] == [good]
