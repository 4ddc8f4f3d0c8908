"""Commands and plans that a stop, a hold-up or a loss voids before they are sent, over real topics."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from rclpy.duration import Duration
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.ros.messages import BUILD, diagnostic_status, motion_result_message, stamp_id
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode

from .planning_bench import ROBOT, PlanningBench


@pytest.fixture
def bench(ros_nodes: Any) -> PlanningBench:
    return PlanningBench(ros_nodes)


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


def test_what_was_commanded_before_the_planner_was_held_up_is_refused(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes, watchdog=0.2)
    home = np.array(bench.robot.home)
    bench.stand(home)
    publisher = bench.publisher('ptpjoint_joint', JointState)
    stamps = [(10, 0), (0, 0)]  # one without a stamp too

    def hold_up() -> None:  # in the executor's thread, so that no command is served meanwhile
        for sec, nanosec in stamps:
            message = BUILD.joint_state(Time(sec=sec, nanosec=nanosec), bench.names, home + 0.1)
            publisher.publish(message)
        assert publisher.wait_for_all_acked(Duration(seconds=10.0))
        bench.node.held_up(60.0)

    bench.peer.executor.create_task(hold_up)
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
        bench.node.silence = lambda: 60.0
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
    commands.publish(BUILD.joint_state(Time(sec=12), bench.names, home + 0.1))
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
    commands.publish(BUILD.joint_state(Time(sec=12), bench.names, home + 0.1))
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
