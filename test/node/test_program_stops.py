"""lua_program_node: what holds, stops and fails a program, and the outputs that it leaves."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from robots_core.ros.messages import diagnostic_status, diagnostic_values
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.qos import STATE
from robots_core.ros.timed_node import TimedNode

from .lua_bench import MOVE, LuaBench, ignore


def test_planner_that_disappears_fails_the_motion_and_stops_the_robot(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    bench.start(MOVE)
    bench.wait_for_command()
    # Destroyed by the thread that spins it.
    bench.on_controller_call = ignore
    destroyed: list[bool] = []
    once = bench.peer.create_timer(0.001, lambda: destroyed or destroyed.append(_destroy(bench)))
    error = bench.wait_for_state('FAILED')['error']
    once.cancel()
    assert 'planning_node has been gone' in error
    bench.wait(lambda: 'cancel' in bench.controller_calls, 'the cancellation')


def _destroy(bench: LuaBench) -> bool:
    for publisher in list(bench.planner.publishers):
        if publisher.topic_name == '/motion_result':
            bench.planner.destroy_publisher(publisher)
    return True


def test_a_stop_by_a_fault_fails_the_program_where_it_is(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.start('print("here")\nwait(1000)')
    bench.wait_for_state('RUNNING')
    stop = diagnostic_status('stop', 'emergency stop', level=DiagnosticStatus.ERROR)
    bench.publish('stop_status', stop, STATE)
    assert bench.wait_for_state('FAILED')['error'].endswith(': emergency stop')


def test_a_fault_sets_outputs_that_a_program_has_left_on(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, fail_safe=['digital_output.2=hold'])
    bench.start('setDigitalOutput(1, true) setDigitalOutput(2, true)')
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.digital[-1][:2] == [1, 1], 'the outputs')
    stop = diagnostic_status('stop', 'emergency stop', level=DiagnosticStatus.ERROR)
    bench.publish('stop_status', stop, STATE)
    bench.wait(lambda: bench.digital[-1][:2] == [0, 1], 'fail-safe outputs')


def test_stop_stops_program_and_robot_until_the_robot_says_so(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    bench.start(MOVE)
    bench.wait_for_command()
    assert bench.ask('stop').success
    bench.wait_for_state('STOPPED')
    # The first one may come before the controller has the trajectory.
    bench.wait(lambda: bench.controller_calls.count('cancel') >= 2, 'another cancellation')
    refused = bench.ask('run')
    assert not refused.success
    assert 'the robot still moves for line 1' in refused.message
    assert bench.ask('get_command_state').message == 'PTPJOINT_JOINT'
    bench.answer(bench.command_id(), 'stopped', ok=False)
    bench.wait(lambda: bench.states[-1] == 'IDLE', 'IDLE')
    bench.on_command = bench.answer
    assert bench.ask('reset').success
    bench.start(MOVE)
    bench.wait_for_state('FINISHED')


def test_outputs_are_fail_safe_after_a_stop_and_the_end_of_the_node_alone(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, fail_safe=['digital_output.2=hold', 'analog_output.1=2.5'])
    on = 'for n = 1, 3 do setDigitalOutput(n, true) end setAnalogOutput(1, 7) '

    def wait_for(digital: list[int], analog: float) -> None:
        bench.wait(lambda: bench.digital[-1][:3] == digital and bench.analog[-1][0] == analog, 'outputs')

    bench.start(on + 'wait(600)')
    wait_for([1, 1, 1], 7.0)
    assert bench.ask('stop').success
    wait_for([0, 1, 0], 2.5)
    bench.wait_for_state('STOPPED')
    bench.start(on)
    bench.wait_for_state('FINISHED')
    wait_for([1, 1, 1], 7.0)
    ros_nodes.destroy(bench.node)
    wait_for([0, 1, 0], 2.5)


def test_stop_before_the_motion_was_sent(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, planner=False)
    bench.start(MOVE)
    bench.wait(lambda: 'PTPJOINT_JOINT' in bench.states, 'the command state')
    assert bench.ask('stop').success
    bench.wait_for_state('STOPPED')
    bench.wait(lambda: bench.states[-1] == 'IDLE', 'IDLE')
    bench.start_planner()
    bench.start('wait(0)')
    bench.wait_for_state('FINISHED')
    assert bench.commands == []


def test_pause_and_resume_hold_program_and_robot(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    bench.start(f'{MOVE}\nsetDigitalOutput(1, 1)')
    bench.wait_for_command()
    assert bench.ask('pause').success
    bench.wait_for_state('PAUSED')
    bench.wait(lambda: bench.controller_calls == ['pause'], 'the pause')
    assert not bench.ask('pause').success
    bench.answer(bench.command_id())
    bench.wait(lambda: bench.states[-1] == 'IDLE', 'IDLE')
    assert not any(any(outputs) for outputs in bench.digital)
    assert bench.ask('resume').success
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.digital[-1][0] == 1, 'the output')
    assert bench.controller_calls == ['pause', 'resume']


def test_a_node_that_was_started_anew_reads_its_outputs_and_what_was_interrupted(
    ros_nodes: Any, tmp_path: Path
):
    path = tmp_path / 'test.lua'
    path.write_text(MOVE)
    reason = 'test.lua was interrupted at line 1: lua_program_node killed by SIGKILL'
    bench = LuaBench(
        ros_nodes,
        tmp_path,
        program=str(path),
        interrupted=reason,
        outputs=['digital_output.2=1', 'analog_output.1=2.5'],
    )
    bench.wait(lambda: bench.digital and bench.analog, 'the outputs')
    assert bench.digital[0][:2] == [0, 1]
    assert bench.analog[0][0] == 2.5
    status = bench.status[-1]
    assert (status.level, status.message) == (DiagnosticStatus.ERROR, reason)
    assert diagnostic_values(status)['state'] == 'OPENED'
    assert bench.ask('run').success
    assert bench.wait_for_state('FINISHED')['error'] == ''


def test_a_program_whose_process_was_frozen_fails_and_leaves_its_outputs_safe(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, watchdog=0.5)
    heartbeat = Heartbeat(bench.node)
    heartbeat.stop()
    bench.start('setDigitalOutput(2, 1) wait(1000)')
    bench.wait(lambda: bench.digital and bench.digital[-1][1] == 1, 'the output')
    for now in (0.0, 0.04, 0.34):
        heartbeat.beat(now)
    assert bench.status[-1].level == DiagnosticStatus.OK
    heartbeat.beat(1000.0)  # however many processes share the processors
    error = bench.wait_for_state('FAILED')['error']
    assert error.endswith('the program was held up for 1e+03 s; its outputs were made safe')
    bench.wait(lambda: bench.digital[-1][1] == 0, 'the output')


def test_a_program_whose_process_was_frozen_commands_nothing_before_it_fails(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, watchdog=0.5)
    heartbeat = Heartbeat(bench.node)
    heartbeat.stop()
    heartbeat.beat(time.monotonic() - 1000.0)  # however many processes share the processors
    bench.start(MOVE)
    bench.wait(lambda: 'PTPJOINT_JOINT' in bench.states, 'the command state')
    heartbeat.beat(time.monotonic())
    assert bench.wait_for_state('FAILED')['error'].endswith('its outputs were made safe')
    assert bench.commands == []


@pytest.mark.parametrize('name', ['planning_node', 'controller_node'])
def test_a_program_whose_robot_stands_fails_when_a_node_that_moves_it_is_lost(
    ros_nodes: Any, tmp_path: Path, name: str
):
    bench = LuaBench(ros_nodes, tmp_path, watchdog=1.0)
    heartbeat = Heartbeat(ros_nodes.add(TimedNode(name, context=ros_nodes.context)))
    bench.wait(lambda: name not in bench.node._motions.watch.unseen, 'its heartbeat')
    bench.start('setDigitalOutput(2, 1) wait(1000)')
    bench.wait(lambda: bench.digital and bench.digital[-1][1] == 1, 'the output')
    heartbeat.stop()
    error = bench.wait_for_state('FAILED')['error']
    assert f'no sign of life of {name} for 1 s' in error
    bench.wait(lambda: bench.digital[-1][1] == 0, 'the output')


def test_outputs_of_no_program_are_safe_when_the_controller_is_lost(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, watchdog=1.0, outputs=['digital_output.2=1'])
    heartbeat = Heartbeat(ros_nodes.add(TimedNode('controller_node', context=ros_nodes.context)))
    bench.wait(lambda: 'controller_node' not in bench.node._motions.watch.unseen, 'its heartbeat')
    bench.wait(lambda: bench.digital and bench.digital[-1][1] == 1, 'the output')
    heartbeat.stop()
    bench.wait(lambda: bench.digital[-1][1] == 0, 'the output')
