"""What stops a robot on its path, and what lets it move again, over real topics."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Bool, Float64

from bench import EVERY_STATE, Bench
from late_drives import PATIENT
from robots_controller.nodes.controller_node import ControllerNode
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_message
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.qos import STATE
from robots_core.ros.timed_node import TimedNode

from .controller_bench import AWAY, FAST_DRIVES, HOME, OPTIONS, ControllerBench


@pytest.fixture
def bench(ros_nodes: Any) -> ControllerBench:
    return ControllerBench(ros_nodes)


@pytest.mark.parametrize('how', ['cancel', 'stop'])
def test_a_motion_is_given_up_and_the_next_one_runs_after_a_stop_once_that_is_reset(
    bench: ControllerBench, how: str
) -> None:
    bench.send_slowly(AWAY)
    bench.ask(how)
    result = bench.result()
    assert not result.ok
    assert result.message == {'cancel': 'canceled by ~/cancel', 'stop': 'stop by ~/stop'}[how]
    bench.until_standing()
    if how == 'stop':
        bench.send(bench.references[-1], HOME)
        assert 'stop by ~/stop; ~/reset lets the robot move again' in bench.result().message
        bench.ask('reset')
    bench.override(1.0)
    bench.send(bench.references[-1], HOME)
    assert bench.result().ok


@pytest.mark.parametrize('how', ['cancel', 'planner'])
def test_a_motion_before_an_obstacle_that_does_not_go_around_it_needs_a_reset(
    bench: ControllerBench, how: str
) -> None:
    sent = bench.send_slowly(AWAY)
    bench.ask('stop_before_collision')
    result = bench.result()
    assert (result.id, result.blocked, result.message) == (sent, True, 'stopped before a collision')
    bench.until_standing()
    if how == 'cancel':
        bench.ask('cancel')
        reason = 'stopped before a collision, without a path around: canceled by ~/cancel'
    else:
        reason = 'stopped before a collision: link_6 comes to 1 mm from post'
        end = MotionResult(sent, ok=False, message=reason)
        bench.publish('motion_result', motion_result_message(end, OPTIONS['robot_model']))
    bench.until_health(DiagnosticStatus.ERROR, reason)
    bench.send(bench.references[-1], HOME, id_=sent)
    refused = f'{reason}; ~/reset lets the robot move again'
    bench.wait(lambda: any(refused in result.message for result in bench.results), 'the refusal')
    bench.results.clear()
    bench.ask('reset')
    bench.override(1.0)
    bench.send(bench.references[-1], HOME)
    assert bench.result().ok


def test_lost_feedback_brakes_on_the_path(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes, feedback_timeout=2.0)
    bench.send_slowly(AWAY)
    bench.drive._loop.stop()
    result = bench.result()
    assert not result.ok
    assert 'no feedback for 2 s' in result.message
    part = (bench.references[-1] - HOME) / (AWAY - HOME)
    np.testing.assert_allclose(part, part[0], atol=0.01)  # now where the drives have followed it to
    bench.wait(
        lambda: any(
            (one.name, one.level) == ('/controller_node', DiagnosticStatus.ERROR) for one in bench.health
        ),
        'an error',
    )


@pytest.mark.parametrize('name', ['planning_node', 'lua_program_node', 'collision_node'])
def test_a_node_that_is_lost_brakes_on_the_path(ros_nodes: Any, name: str) -> None:
    bench = ControllerBench(ros_nodes, watchdog=1.0)
    node = ros_nodes.add(TimedNode(name, context=ros_nodes.context))
    heartbeat = Heartbeat(node)
    bench.wait(lambda: name not in bench.controller.watch.unseen, 'its heartbeat')
    bench.send_slowly(AWAY)
    heartbeat.stop()
    result = bench.result()
    assert not result.ok
    assert result.message.startswith(f'no sign of life of {name} for 1 s')
    part = (bench.references[-1] - HOME) / (AWAY - HOME)
    np.testing.assert_allclose(part, part[0], atol=1e-9)
    if name == 'collision_node':  # without it the robot would move unguarded
        assert 'cannot reset: no sign of life' in bench.call('controller_node/reset').message
        heartbeat = Heartbeat(node)
    bench.wait(lambda: bench.call('controller_node/reset').success, 'the reset')
    heartbeat.stop()


@pytest.mark.parametrize('how', ['service', 'topic'])
def test_an_emergency_stop_holds_until_it_is_released_and_reset(bench: ControllerBench, how: str) -> None:
    drives_on = bench.collect('drives_on', Bool, EVERY_STATE, lambda message: message.data)
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE)
    bench.send_slowly(AWAY)
    if how == 'service':
        bench.ask('emergency_stop')
    else:
        bench.publish('emergency_stop', Bool(data=True), STATE)
    result = bench.result()
    assert not result.ok
    assert 'emergency stop' in result.message
    bench.wait(lambda: drives_on[-1:] == [False], 'drives that are off')
    assert diagnostic_values(stops[-1])['category'] == '1'
    bench.override(1.0)
    bench.send(bench.references[-1], HOME)
    assert bench.result().message == f'{result.message}; ~/reset lets the robot move again'
    if how == 'topic':
        assert 'cannot reset: emergency stop' in bench.call('controller_node/reset').message
        bench.publish('emergency_stop', Bool(data=False), STATE)
        bench.wait(lambda: bench.call('controller_node/reset').success, 'the reset')
    else:
        bench.ask('reset')
    bench.wait(lambda: drives_on[-1], 'drives that are on')
    bench.send(bench.references[-1], HOME)
    assert bench.result().ok


def test_a_stop_of_the_robot_itself_holds_until_it_runs_again(bench: ControllerBench) -> None:
    bench.publish('speed_scaling', Float64(data=0.4), STATE)
    bench.wait(lambda: bench.controller._controller.speed.scaling == 0.4, 'the scaling')
    bench.send_slowly(AWAY)
    bench.publish('robot_running', Bool(data=False), STATE)
    result = bench.result()
    assert not result.ok
    assert result.message == 'the robot has stopped by itself: its driver does not follow'
    assert 'cannot reset: the robot has stopped' in bench.call('controller_node/reset').message
    bench.publish('robot_running', Bool(data=True), STATE)
    bench.wait(lambda: bench.call('controller_node/reset').success, 'the reset')


@pytest.mark.parametrize(
    ('fault', 'axes', 'feedback_timeout', 'reason'),
    [
        ('fault_stopped', ['A2'], PATIENT, 'does the drive follow?'),
        ('fault_frozen', ['A3'], PATIENT, 'does the drive follow?'),
        ('fault_lost', ['A5'], 0.5, 'no feedback for 0.5 s'),
    ],
)
def test_a_fault_of_the_drives_stops_the_motion(
    ros_nodes: Any, fault: str, axes: list[str], feedback_timeout: float, reason: str
) -> None:
    bench = ControllerBench(ros_nodes, feedback_timeout=feedback_timeout)
    far = HOME + np.array([0.0, 0.6, -0.6, 0.0, 0.6, 0.0])
    bench.send_slowly(far, duration=2.0)
    bench.set_parameters(bench.drive, **{fault: axes})
    bench.override(1.0)
    result = bench.result()
    assert not result.ok
    assert reason in result.message
    bench.until_standing()


def test_a_controller_that_is_started_again_in_a_launch_stays_stopped_until_its_reset(
    ros_nodes: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv('XDG_RUNTIME_DIR', str(tmp_path))
    bench = Bench(ros_nodes)
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE, diagnostic_values)
    bench.start_node(DriveNode, **OPTIONS, **FAST_DRIVES)
    options = {**OPTIONS, 'feedback_timeout': PATIENT}
    for launch in ('monday', 'tuesday'):
        first = bench.start_node(ControllerNode, **options, launch=launch)
        bench.wait(lambda: stops and 'fault' not in stops[-1], 'a robot that may move')
        ros_nodes.destroy(first)
        again = bench.start_node(ControllerNode, **options, launch=launch)
        bench.wait(lambda: stops[-1].get('fault') == 'controller lost', 'the fault')
        bench.wait(lambda: bench.call('controller_node/reset').success, 'a reset')
        bench.wait(lambda: 'fault' not in stops[-1], 'a robot that may move')
        ros_nodes.destroy(again)
        stops.clear()


def test_a_controller_that_cannot_find_out_whether_it_was_started_before_stays_stopped(
    ros_nodes: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / 'no folder'
    folder.touch()
    monkeypatch.setenv('XDG_RUNTIME_DIR', str(folder))
    bench = Bench(ros_nodes)
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE, lambda message: message.message)
    bench.start_node(ControllerNode, **OPTIONS, launch='monday')
    bench.wait(lambda: stops and 'has been started before is not known' in stops[-1], 'the fault')
