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
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String

from robots_core import Pose
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import (
    diagnostic_status,
    diagnostic_values,
    joint_state_message,
    motion_result_message,
    pose_stamped_message,
    stamp_id,
)
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode
from robots_planning import LinearCartesianLimited, MotionSettings, verify
from robots_planning.motion_settings import settings_from_text
from robots_planning.nodes.planning_node import PlanningNode

from .bench import Bench
from .planning_bench import ROBOT, PlanningBench


@pytest.fixture
def bench(ros_nodes: Any) -> PlanningBench:
    return PlanningBench(ros_nodes)


def below(bench: PlanningBench, distance: float = 0.1) -> Pose:
    """A pose straight below home."""
    start = Pose(*bench.robot.direct_kinematics(bench.robot.home))
    return Pose(start.r - [0.0, 0.0, distance], start.T)


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
    home, target = bench.robot.home, below(bench)
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
    target = below(bench)
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
    second = bench.command('ptpjoint_cartesian', below(bench), 6)
    bench.planned(2)
    bench.command('ptpjoint_joint', home, 7)
    third = bench.planned(3)
    starts = [message.points[0] for message in bench.trajectories]
    np.testing.assert_array_equal(starts[1].positions, home + 0.1)
    assert Pose(*bench.robot.direct_kinematics(third.position[0])).distance_to(below(bench))[0] < 1e-9
    assert all(point.time_from_start.nanosec == 0 for point in starts)
    bench.end(first)
    assert not bench.finished[-1]
    bench.end(second)
    bench.end('7.000000000')
    bench.wait(lambda: bench.finished[-1], 'finished with the last of them')


def test_after_a_stop_nothing_moves_that_was_commanded_before(bench: PlanningBench) -> None:
    home = bench.robot.home
    bench.stand(home)
    first = bench.command('ptpjoint_joint', home + 0.1, 5)
    bench.planned()
    bench.stand(home + 0.03)  # on its way, stopped there
    stopped = bench.node.get_clock().now().nanoseconds * 1e-9 + 3600.0
    late = MotionResult(first, ok=False, message='stopped', details={'ended': f'{stopped:.9f}'})
    bench.publish('motion_result', motion_result_message(late, ROBOT))
    bench.wait(lambda: not bench.node.planner.holds(first), 'the stop is with the node')
    void = bench.command('ptpjoint_joint', home, 6)  # sent before that stop
    assert f'given up with motion {first} before it' in bench.refusal(void).message
    assert len(bench.trajectories) == 1


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
        poses = [pose_stamped_message(Time(sec=stamp), Pose(r, start.T)) for r in points]
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


def test_a_lost_controller_does_not_block_the_next_motion(bench: PlanningBench) -> None:
    home = bench.robot.home
    bench.stand(home)
    bench.command('ptpjoint_joint', home + 0.1, 5)
    bench.planned()
    bench.runner.call(lambda: bench.peer.destroy_publisher(bench.references))
    bench.wait(lambda: not bench.node.get_publishers_info_by_topic('joint_reference'), 'it is gone')
    bench.references = None
    bench.stand(home)
    bench.command('ptpjoint_joint', home + 0.1, 6)
    bench.planned(2)


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
    bench.publish('ptpcartesian', pose_stamped_message(Time(sec=5), below(bench), 'camera'))
    assert (
        "frame 'camera' is unknown; valid are 'base' and 'base_link'" in bench.refusal('5.000000000').message
    )


def test_base_link_of_a_ur_arm_is_turned(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes, robot_model='ur5e')
    bench.stand(bench.robot.home)
    there = below(bench)
    turned = np.diag([-1.0, -1.0, 1.0])  # as their driver's frames are
    bench.publish(
        'ptpcartesian',
        pose_stamped_message(Time(sec=5), Pose(turned @ there.r, turned @ there.T), 'base_link'),
    )
    r, T = bench.robot.direct_kinematics(bench.planned().position[-1])
    np.testing.assert_allclose(r, there.r, atol=1e-6)
    np.testing.assert_allclose(T, there.T, atol=1e-6)


def test_base_link_is_the_base(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    bench.publish('ptpcartesian', pose_stamped_message(Time(sec=5), below(bench), 'base_link'))
    r, _ = bench.robot.direct_kinematics(bench.planned().position[-1])
    np.testing.assert_allclose(r, below(bench).r, atol=1e-6)


def test_trigger_moves_to_the_newest_reference_pose_on_its_rising_edge(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    bench.publish('trigger', Bool(data=True))
    bench.wait(lambda: bench.results, 'a refusal')
    assert 'without a valid reference_pose' in bench.results[0].message
    bench.publish('reference_pose', pose_stamped_message(Time(), below(bench)))
    bench.wait(lambda: bench.node.planner.reference_pose is not None, 'the pose is taken')
    bench.publish('trigger', Bool(data=True))  # still high: no edge
    bench.publish('trigger', Bool(data=False))
    bench.publish('trigger', Bool(data=True))
    trajectory = bench.planned()
    reached = Pose(*bench.robot.direct_kinematics(trajectory.position[-1]))
    assert reached.distance_to(below(bench))[0] < 1e-9
    assert len(bench.results) == 1


def test_modal_settings_hold_from_the_next_command_on(bench: PlanningBench) -> None:
    bench.stand(bench.robot.home)
    usual = LinearCartesianLimited(bench.robot).generate(bench.robot.home, below(bench)).duration
    bench.runner.wait_for(
        lambda: all(
            result.successful
            for result in bench.node.set_parameters(
                [Parameter('cartesian_speed', value=0.01), Parameter('speed_fraction', value=0.5)]
            )
        ),
        what='the settings are taken',
    )
    bench.command('ptpcartesian', below(bench), 5)
    # 0.1 m at 0.01 m/s.
    assert bench.planned().duration > 10.0 > usual


@pytest.mark.parametrize('value', [0.0, -1.0, float('nan'), float('inf'), 2.0])
def test_invalid_settings_are_refused_and_change_nothing(bench: PlanningBench, value: float) -> None:
    result = bench.node.set_parameters_atomically(
        [Parameter('cartesian_speed', value=0.1), Parameter('speed_fraction', value=value)]
    )
    assert not result.successful
    assert 'speed_fraction' in result.reason
    assert bench.node.get_parameter('cartesian_speed').value == 0.5


def test_the_settings_are_published(ros_nodes: Any) -> None:
    tool = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0]
    bench = PlanningBench(ros_nodes, tool=tool)
    published: list[MotionSettings] = []
    bench.peer.create_subscription(
        DiagnosticStatus,
        'motion_settings',
        lambda message: published.append(settings_from_text(diagnostic_values(message))),
        STATE,
    )
    bench.wait(lambda: published, 'the settings of the start')
    assert published == [MotionSettings(tool=tuple(tool))]
    bench.node.set_parameters([Parameter('new_command', value='queue')])  # no setting of a motion
    bench.node.set_parameters_atomically(
        [Parameter('cartesian_speed', value=0.1), Parameter('blend_zone', value=0.02)]
    )
    bench.wait(lambda: len(published) > 1, 'the change')
    assert published[1:] == [MotionSettings(tool=tuple(tool), cartesian_speed=0.1, blend_zone=0.02)]


def test_an_invalid_setting_at_start_is_reported(ros_nodes: Any) -> None:
    with pytest.raises(InvalidInputError, match='rotation_speed'):
        PlanningBench(ros_nodes, rotation_speed=-1.0)


def test_what_was_commanded_before_the_planner_was_held_up_is_refused(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes, watchdog=0.2)
    home = np.array(bench.robot.home)
    bench.stand(home)
    publisher = bench.publisher('ptpjoint_joint', JointState)
    stamps = [(10, 0), (0, 0)]  # one without a stamp too

    def hold_up() -> None:  # in the executor's thread, so that no command is served meanwhile
        for sec, nanosec in stamps:
            message = joint_state_message(Time(sec=sec, nanosec=nanosec), bench.names, home + 0.1)
            publisher.publish(message)
        assert publisher.wait_for_all_acked(Duration(seconds=10.0))
        bench.node.held_up(60.0)

    once = bench.peer.create_guard_condition(hold_up)
    once.trigger()
    bench.wait(lambda: len(bench.results) >= len(stamps), 'the refusals')
    assert {result.message for result in bench.results} == {
        'planning_node was held up after this was commanded; command it again'
    }
    assert not bench.trajectories
    bench.command('ptpjoint_joint', home + 0.1, 11)
    bench.planned()


def long_plan(bench: PlanningBench) -> tuple[threading.Event, threading.Event]:
    """Plans that begin with the first event, and end after the second one."""
    begun, goes_on = threading.Event(), threading.Event()
    plan = bench.node.planner.planning.plan

    def plan_late(*given: Any) -> Any:
        begun.set()
        assert goes_on.wait(60.0)
        return plan(*given)

    bench.node.planner.planning.plan = plan_late
    return begun, goes_on


@pytest.mark.parametrize('noticed', [True, False])
def test_what_is_planned_when_the_planner_is_held_up_is_not_sent(ros_nodes: Any, *, noticed: bool) -> None:
    bench = PlanningBench(ros_nodes, watchdog=0.2)
    home = np.array(bench.robot.home)
    bench.stand(home)
    begun, goes_on = long_plan(bench)
    id_ = bench.command('ptpjoint_joint', home + 0.1, 12)
    assert begun.wait(60.0)
    if noticed:  # by the thread that gives signs of life
        bench.node.held_up(60.0)
    else:  # the thread that plans is the first to continue
        bench.node.gives_signs_of_life(lambda: 60.0)
    goes_on.set()
    assert bench.refusal(id_).message == 'given up: the planner was held up'
    assert not bench.trajectories


@pytest.mark.parametrize('how', ['its program is lost', 'the pendant takes the robot'])
def test_what_is_planned_when_its_commander_loses_the_robot_is_not_sent(ros_nodes: Any, how: str) -> None:
    bench = PlanningBench(ros_nodes, watchdog=1.0)
    home = np.array(bench.robot.home)
    bench.stand(home)
    program = ros_nodes.add(TimedNode('lua_program_node', context=ros_nodes.context))
    heartbeat = Heartbeat(program)
    commands = program.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
    commander = bench.publisher('commander', String, STATE)
    commander.publish(String(data='PROGRAM'))
    bench.wait(lambda: bench.node.admission.commanders.commander is Commander.PROGRAM, 'the commander')
    bench.wait(lambda: 'lua_program_node' not in bench.node.admission.watch.unseen, 'its heartbeat')
    begun, goes_on = long_plan(bench)
    commands.publish(joint_state_message(Time(sec=12), bench.names, home + 0.1))
    assert begun.wait(60.0)
    failures = bench.node.planner._queue.failures
    if how == 'its program is lost':
        heartbeat.stop()
    else:
        commander.publish(String(data='PENDANT'))
    bench.wait(lambda: bench.node.planner._queue.failures > failures, 'that it is given up')
    goes_on.set()
    assert bench.refusal('12.000000000').message in {
        'given up: no sign of life of lua_program_node for 1 s: is it still running?',
        'given up: PENDANT has taken the robot',
    }
    assert not bench.trajectories
    heartbeat.stop()


def test_what_is_planned_when_the_robot_is_stopped_is_not_sent_and_what_comes_later_is(
    ros_nodes: Any,
) -> None:
    bench = PlanningBench(ros_nodes)
    home = np.array(bench.robot.home)
    bench.stand(home)
    begun, goes_on = long_plan(bench)
    id_ = bench.command('ptpjoint_joint', home + 0.1, 12)
    assert begun.wait(60.0)
    until = bench.node.time()
    later = bench.command('ptpjoint_joint', home + 0.1, 13)
    bench.wait(lambda: bench.node.planner.holds(later), 'the second command')
    stop = diagnostic_status('stop', 'canceled by ~/cancel', hardware_id='', until=f'{until:.9f}')
    bench.publish('stop_status', stop, STATE)
    bench.wait(lambda: bench.node.planner._queue.failures, 'that it is given up')
    goes_on.set()
    assert bench.refusal(id_).message == 'given up: canceled by ~/cancel'
    bench.planned()
    assert [stamp_id(message.header.stamp) for message in bench.trajectories] == [later]


def test_a_commander_that_takes_the_robot_keeps_what_it_has_commanded(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes)
    home = np.array(bench.robot.home)
    bench.stand(home)
    program = ros_nodes.add(TimedNode('lua_program_node', context=ros_nodes.context))
    commands = program.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
    commander = bench.publisher('commander', String, STATE)
    begun, goes_on = long_plan(bench)
    commands.publish(joint_state_message(Time(sec=12), bench.names, home + 0.1))
    assert begun.wait(60.0)
    commander.publish(String(data='PROGRAM'))  # it comes on another topic than the command, and later
    bench.wait(lambda: bench.node.admission.commanders.commander is Commander.PROGRAM, 'the commander')
    goes_on.set()
    bench.planned()


def test_a_short_silence_of_the_planner_changes_nothing(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes, watchdog=10.0)
    home = np.array(bench.robot.home)
    bench.stand(home)
    bench.node.held_up(1.0)
    bench.command('ptpjoint_joint', home + 0.1, 13)
    bench.planned()


def test_motions_of_a_controller_that_is_lost_are_ended(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes, watchdog=1.0)
    controller = ros_nodes.add(TimedNode('controller_node', context=ros_nodes.context))
    heartbeat = Heartbeat(controller)
    bench.wait(lambda: bench.node.count_publishers('controller_node/heartbeat'), 'the heartbeat')
    home = np.array(bench.robot.home)
    bench.stand(home)
    id_ = bench.command('ptpjoint_joint', home + 0.1, 1)
    bench.planned()
    heartbeat.stop()
    bench.wait(lambda: bench.results, 'its end')
    assert (bench.results[0].id, bench.results[0].ok) == (id_, False)
    assert bench.results[0].message.startswith('no sign of life of controller_node for 1 s')
    bench.wait(lambda: not bench.node.planner.moving, 'a planner that is free')
