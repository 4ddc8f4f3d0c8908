"""planning_node: commands in; joint_trajectory, refusals and finished out."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rcl_interfaces.srv import GetParameters
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool

from bench import Bench
from robots_core import Pose
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import BUILD, motion_result_message
from robots_planning import LinearCartesianLimited, verify
from robots_planning.nodes.planning_node import PlanningNode

from .planning_bench import ROBOT, PlanningBench


@pytest.fixture
def bench(ros_nodes: Any) -> PlanningBench:
    return PlanningBench(ros_nodes)


def test_a_joint_motion_is_planned_and_verified(bench: PlanningBench) -> None:
    home = bench.robot.home
    bench.stand(home)
    bench.command('ptpjoint_joint', home + 0.2, 5)
    trajectory = bench.planned()
    message = bench.trajectories[0]
    assert message.header.stamp == Time(sec=5)
    assert message.header.frame_id == 'base'
    assert list(message.joint_names) == bench.names
    np.testing.assert_array_equal(trajectory.position[0], home)
    np.testing.assert_array_equal(trajectory.position[-1], home + 0.2)
    report = verify(trajectory, bench.robot, torque=False)
    assert report.ok, report.describe()


def test_joints_are_matched_by_name(bench: PlanningBench) -> None:
    home = bench.robot.home
    target = home + np.linspace(0.01, 0.07, bench.robot.num_axes)
    bench.stand(home)
    message = JointState(name=['gripper', *reversed(bench.names)], position=[9.0, *reversed(target)])
    bench.publish('ptpjoint_joint', message)
    np.testing.assert_array_equal(bench.planned().position[-1], target)
    # A command without stamp gets the time as its id.
    assert bench.trajectories[0].header.stamp.sec > 0


def test_a_tool_line_survives_the_message(bench: PlanningBench) -> None:
    home, target = bench.robot.home, bench.below()
    bench.stand(home)
    bench.command('ptpcartesian', target, 5)
    trajectory = bench.planned()
    line = (Pose(*bench.robot.direct_kinematics(home)), target)
    report = verify(trajectory, bench.robot, line=line)
    assert report.ok, report.describe()
    assert report.uses['acceleration'].ratio <= 1.0
    planned = LinearCartesianLimited(bench.robot).generate(home, target)
    # The orientation travels as a quaternion, which is rounded once more.
    assert trajectory.duration == pytest.approx(planned.duration, rel=1e-6)
    assert bench.finished[-1] is False


def test_a_pose_is_reached_in_joint_space(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    target = bench.below()
    bench.command('ptpjoint_cartesian', target, 5)
    reached = Pose(*bench.robot.direct_kinematics(bench.planned().position[-1]))
    assert reached.distance_to(target)[0] < 1e-9


def test_finished_follows_the_result_of_its_own_motion(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    id_ = bench.command('ptpjoint_joint', bench.robot.home + 0.1, 5)
    bench.planned()
    bench.wait(lambda: bench.finished == [False, False], 'finished false at the start')
    bench.end('4.000000000')
    bench.end(id_)
    bench.wait(lambda: bench.finished == [False, False, True], 'finished true at the end')


def test_a_motion_that_was_stopped_is_not_finished(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    id_ = bench.command('ptpjoint_joint', bench.robot.home + 0.1, 5)
    bench.planned()
    bench.end(id_, ok=False)
    bench.command('ptpjoint_joint', bench.robot.home + 0.1, 6)
    bench.planned(2)
    assert True not in bench.finished


def test_without_a_reference_it_says_what_is_missing(bench: PlanningBench) -> None:
    id_ = bench.command('ptpjoint_joint', bench.robot.home, 5)
    assert 'no joint_reference received' in bench.refusal(id_).message
    assert not bench.trajectories


def test_a_moving_robot_is_not_planned_for(bench: PlanningBench) -> None:
    home = bench.robot.home
    velocity = np.zeros(len(home))
    velocity[2] = 0.3
    bench.stand(home, velocity)
    result = bench.refusal(bench.command('ptpjoint_joint', home + 0.1, 5))
    assert 'still moving' in result.message
    assert bench.names[2] in result.message
    bench.stand(home)
    bench.command('ptpjoint_joint', home + 0.1, 6)
    bench.planned()


def test_a_command_that_comes_while_the_robot_moves_goes_on_from_its_end(bench: PlanningBench) -> None:
    home = bench.robot.home
    bench.stand(home)
    first = bench.command('ptpjoint_joint', home + 0.1, 5)
    bench.planned()  # messages of different topics may overtake each other
    second = bench.command('ptpjoint_cartesian', bench.below(), 6)
    bench.planned(2)
    bench.command('ptpjoint_joint', home, 7)
    third = bench.planned(3)
    starts = [message.points[0] for message in bench.trajectories]
    np.testing.assert_array_equal(starts[1].positions, home + 0.1)
    assert Pose(*bench.robot.direct_kinematics(third.position[0])).distance_to(bench.below())[0] < 1e-9
    assert all(point.time_from_start.nanosec == 0 for point in starts)
    bench.end(first)
    assert not bench.finished[-1]
    bench.end(second)
    bench.end('7.000000000')
    bench.wait(lambda: bench.finished[-1], 'finished with the last of them')


@pytest.mark.parametrize(('key', 'value'), [('ended', 'soon'), ('ended', 'nan'), ('progress', '1e999')])
def test_a_motion_result_with_a_number_that_is_none_is_refused(ros_nodes: Any, key: str, value: str) -> None:
    bench = Bench(ros_nodes)
    bench.start_node(PlanningNode, robot_model=ROBOT)
    bad = MotionResult('5.000000000', ok=False, message='stopped', details={key: value})
    bench.publish('motion_result', motion_result_message(bad, ROBOT))
    bench.until_health(DiagnosticStatus.WARN, f"motion_result: {key} = '{value}' must be a finite number")


def test_a_command_after_a_stop_starts_where_the_robot_stands(bench: PlanningBench) -> None:
    home = bench.robot.home
    bench.stand(home)
    first = bench.command('ptpjoint_joint', home + 0.1, 5)
    bench.planned()
    bench.stand(home + 0.03)
    bench.end(first, ok=False)
    bench.command('ptpjoint_joint', home, 6)
    np.testing.assert_array_equal(bench.planned(2).position[0], home + 0.03)


def test_a_replacing_command_joins_the_running_motion(ros_nodes: Any) -> None:
    # Slow: it still runs when a busy machine gets round to the second command.
    bench = PlanningBench(ros_nodes, new_command='replace', speed_fraction=0.02)
    home = bench.robot.home
    bench.stand(home)
    bench.command('ptpjoint_joint', home + 0.4, 5)
    assert bench.planned().duration > 10.0
    bench.command('ptpjoint_joint', home - 0.1, 6)
    bench.wait(lambda: len(bench.trajectories) == 2, 'the motion in its place')
    start, *_, end = bench.trajectories[1].points
    assert start.time_from_start.sec + 1e-9 * start.time_from_start.nanosec > 0.0
    np.testing.assert_allclose(end.positions, home - 0.1, atol=1e-9)


def test_an_unknown_new_command_is_refused(ros_nodes: Any) -> None:
    with pytest.raises(InvalidInputError, match='valid are queue and replace'):
        PlanningBench(ros_nodes, new_command='interrupt')


def test_planning_does_not_keep_the_node_from_answering(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    planning, entered, leave = bench.node.planner.planning, threading.Event(), threading.Event()
    plan = planning.plan

    def slow(*arguments: Any, **options: Any) -> Any:
        entered.set()
        assert leave.wait(240.0)
        return plan(*arguments, **options)

    planning.plan = slow
    bench.command('ptpjoint_joint', bench.robot.home + 0.1, 5)
    bench.wait(entered.is_set, 'the node plans')
    client = bench.peer.create_client(GetParameters, 'planning_node/get_parameters')
    bench.wait(client.service_is_ready, 'the parameter service')
    future = client.call_async(GetParameters.Request(names=['speed_fraction']))
    bench.wait(future.done, 'an answer while it plans')
    assert not bench.trajectories
    leave.set()
    bench.planned()


def test_a_circle_and_a_spline_are_planned(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    start = Pose(*bench.robot.direct_kinematics(bench.robot.home))
    points = list(start.r + np.array([[0.0, 0.05, -0.05], [0.0, 0.0, -0.1]]))
    for stamp, topic in ((5, 'circcartesian'), (6, 'splinecartesian')):
        poses = [BUILD.pose_stamped(Time(sec=stamp), Pose(r, start.T)) for r in points]
        path = Path(poses=poses)
        path.header.stamp = Time(sec=stamp)
        bench.publish(topic, path)
        trajectory = bench.planned(stamp - 4)
        reached = Pose(*bench.robot.direct_kinematics(trajectory.position[-1]))
        assert np.abs(reached.r - points[-1]).max() < 1e-9
        points = list(start.r + np.array([[0.0, -0.05, -0.05], [0.0, 0.0, 0.0]]))


def test_a_tool_and_a_base_are_applied(ros_nodes: Any) -> None:
    tool, base = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0]
    bench = PlanningBench(ros_nodes, tool=tool, base=base)
    bench.stand(bench.robot.home)
    start = Pose(*bench.robot.direct_kinematics(bench.robot.home))
    tip = start @ Pose(np.array([0.0, 0.0, 0.1]), np.eye(3))
    target = Pose(tip.r - [0.0, 0.0, 0.25], tip.T)  # 0.2 m lower in the frame that is 0.2 m higher
    for stamp, topic in ((5, 'ptpcartesian'), (6, 'ptpjoint_cartesian')):
        bench.command(topic, target, stamp)
        reached = Pose(*bench.robot.direct_kinematics(bench.planned(stamp - 4).position[-1]))
        assert reached.distance_to(Pose(start.r - [0.0, 0.0, 0.05], start.T))[0] < 1e-9


def test_a_command_that_comes_twice_is_planned_once(bench: PlanningBench) -> None:
    home = bench.robot.home
    bench.stand(home)
    first = bench.command('ptpjoint_joint', home + 0.1, 5)
    bench.command('ptpjoint_joint', home + 0.1, 5)
    bench.command('ptpjoint_joint', home, 6)
    bench.planned(2)
    assert [message.header.stamp.sec for message in bench.trajectories] == [5, 6]
    assert first not in [result.id for result in bench.results]


@pytest.mark.parametrize(
    ('topic', 'message', 'reason'),
    [
        ('ptpjoint_joint', JointState(name=['J1'], position=[0.0]), 'lacks joint J2'),
        ('ptpjoint_joint', JointState(), 'lacks joint J1'),
        ('ptpjoint_cartesian', PoseStamped(), 'cannot reach'),
        ('ptpcartesian', PoseStamped(), 'cannot reach'),
    ],
)
def test_bad_commands_are_refused_with_the_reason(
    bench: PlanningBench, topic: str, message: Any, reason: str
) -> None:
    bench.stand(bench.robot.home)
    message.header.stamp = Time(sec=5)
    if topic != 'ptpjoint_joint':
        message.pose.position.x = 50.0
    bench.publish(topic, message)
    result = bench.refusal('5.000000000')
    assert reason in result.message
    assert not bench.trajectories
    bench.command('ptpjoint_joint', bench.robot.home, 6)
    bench.planned()


def test_values_and_bounds_travel_with_a_refusal(bench: PlanningBench) -> None:
    axes, home = bench.robot.axes_data, bench.robot.home
    bench.stand(home)
    target = home.copy()
    target[3] = axes.upper[3] + 0.5
    details = bench.refusal(bench.command('ptpjoint_joint', target, 5)).details
    assert details['joint'] == axes.names[3]
    assert float(details['upper']) == axes.upper[3]
    assert float(details['value']) == target[3]
    target[3] = np.nan
    assert 'nan' in bench.refusal(bench.command('ptpjoint_joint', target, 6)).message


def test_a_pose_in_another_frame_is_refused(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    bench.publish('ptpcartesian', BUILD.pose_stamped(Time(sec=5), bench.below(), 'camera'))
    assert (
        "frame 'camera' is unknown; valid are 'base' and 'base_link'" in bench.refusal('5.000000000').message
    )


def test_base_link_of_a_ur_arm_is_turned(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes, robot_model='ur5e')
    bench.stand(bench.robot.home)
    there = bench.below()
    turned = np.diag([-1.0, -1.0, 1.0])  # as their driver's frames are
    bench.publish(
        'ptpcartesian',
        BUILD.pose_stamped(Time(sec=5), Pose(turned @ there.r, turned @ there.T), 'base_link'),
    )
    r, T = bench.robot.direct_kinematics(bench.planned().position[-1])
    np.testing.assert_allclose(r, there.r, atol=1e-6)
    np.testing.assert_allclose(T, there.T, atol=1e-6)


def test_base_link_is_the_base(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    bench.publish('ptpcartesian', BUILD.pose_stamped(Time(sec=5), bench.below(), 'base_link'))
    r, _ = bench.robot.direct_kinematics(bench.planned().position[-1])
    np.testing.assert_allclose(r, bench.below().r, atol=1e-6)


def test_trigger_moves_to_the_newest_reference_pose_on_its_rising_edge(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    bench.publish('trigger', Bool(data=True))
    bench.wait(lambda: bench.results, 'a refusal')
    assert 'without a valid reference_pose' in bench.results[0].message
    bench.publish('reference_pose', BUILD.pose_stamped(Time(), bench.below()))
    bench.wait(lambda: bench.node.planner.reference_pose is not None, 'the pose is taken')
    bench.publish('trigger', Bool(data=True))  # still high: no edge
    bench.publish('trigger', Bool(data=False))
    bench.publish('trigger', Bool(data=True))
    trajectory = bench.planned()
    reached = Pose(*bench.robot.direct_kinematics(trajectory.position[-1]))
    assert reached.distance_to(bench.below())[0] < 1e-9
    assert len(bench.results) == 1
