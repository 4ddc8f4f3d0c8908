"""Motions that a loss, a hold-up or a cancellation voids before they begin, over real topics."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.duration import Duration
from std_msgs.msg import String
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory

from bench import EVERY_STATE
from late_drives import PATIENT
from robots_controller.control import motion_admission
from robots_controller.control.stops.faults import Fault
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.timed_node import TimedNode
from robots_core.status import Level, Status

from .controller_bench import AWAY, HOME, ControllerBench


@pytest.fixture
def bench(ros_nodes: Any) -> ControllerBench:
    return ControllerBench(ros_nodes)


def test_a_motion_of_a_program_that_is_lost_does_not_begin(
    ros_nodes: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(motion_admission, 'GIVEN_UP_AFTER', 1e3)  # s: no machine is too slow for it
    bench = ControllerBench(ros_nodes, watchdog=1.0)
    heartbeat = Heartbeat(ros_nodes.add(TimedNode('lua_program_node', context=ros_nodes.context)))
    bench.wait(lambda: 'lua_program_node' not in bench.controller.watch.unseen, 'its heartbeat')
    request = SetBool.Request(data=True)
    assert bench.call('controller_node/commander/program', request, SetBool).success
    commanders = bench.collect('commander', String, EVERY_STATE, lambda message: message.data)
    heartbeat.stop()
    bench.wait(lambda: commanders[-1:] == ['NOBODY'], 'a robot that is free')
    bench.send(HOME, AWAY)  # as a planner that has not noticed it yet
    result = bench.result()
    assert not result.ok
    assert result.message.startswith('given up: no sign of life of lua_program_node')


@pytest.mark.parametrize('when', ['while it is lost', 'when it is back'])
def test_a_motion_that_was_commanded_before_the_planner_was_lost_does_not_begin(
    ros_nodes: Any, monkeypatch: pytest.MonkeyPatch, when: str
) -> None:
    monkeypatch.setattr(motion_admission, 'GIVEN_UP_AFTER', 1e3)  # s: no machine is too slow for it
    bench = ControllerBench(ros_nodes, watchdog=1.0)
    planner = ros_nodes.add(TimedNode('planning_node', context=ros_nodes.context))
    heartbeat = Heartbeat(planner)
    bench.wait(lambda: 'planning_node' not in bench.controller.watch.unseen, 'its heartbeat')
    commanded = bench.stamp()
    heartbeat.stop()
    watch = bench.controller.watch  # its loop sees a loss before its executor deals with it
    bench.wait(lambda: watch.lost and not watch._changes, 'the loss')
    if when == 'when it is back':
        heartbeat = Heartbeat(planner)
        bench.wait(lambda: not watch.lost and not watch._changes, 'its return')
    bench.send(HOME, AWAY, id_=commanded)  # as a planner that was frozen right before it sent this
    result = bench.result()
    assert not result.ok
    assert result.message.startswith('given up: no sign of life of planning_node')
    np.testing.assert_array_equal(bench.references[-1], HOME)
    bench.results.clear()
    bench.send(HOME, AWAY)  # commanded since
    assert bench.result().ok
    heartbeat.stop()


def test_a_motion_that_was_sent_before_the_controller_was_held_up_is_refused(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes)
    before = bench.references[-1]

    def hold_up() -> None:  # in the executor's thread, so that nothing is served meanwhile
        bench.send(HOME, AWAY)
        assert bench.trajectories.wait_for_all_acked(Duration(seconds=10.0))
        bench.controller.held_up(60.0 * PATIENT)

    bench.peer.executor.create_task(hold_up)
    result = bench.result()
    assert not result.ok
    assert result.message == 'controller_node was held up after this was commanded; command it again'
    np.testing.assert_array_equal(bench.references[-1], before)
    bench.send(HOME, AWAY)
    assert bench.result().ok


@pytest.mark.parametrize('how', ['service', 'an empty trajectory'])
def test_a_cancellation_of_a_robot_that_stands_is_published_for_what_is_still_being_planned(
    bench: ControllerBench, how: str
) -> None:
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE)
    bench.wait(lambda: stops, 'the state')
    before = bench.controller.get_clock().now().nanoseconds
    if how == 'service':
        bench.ask('cancel')
    else:
        bench.trajectories.publish(JointTrajectory())
    bench.wait(lambda: len(stops) > 1, 'the stop')
    assert (stops[-1].level, stops[-1].message.split(' ')[0]) == (DiagnosticStatus.OK, 'canceled')
    assert float(diagnostic_values(stops[-1])['until']) >= 1e-9 * before
    bench.send(HOME, AWAY)  # it is not latched
    assert bench.result().ok


def test_a_cancellation_is_not_reported_after_a_stop_that_comes_meanwhile(
    bench: ControllerBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    controller, reported = bench.controller, list[str]()
    publish, stopped = controller._publish_stop, threading.Event()

    def publish_slowly(status: Status) -> None:
        if status.level is Level.OK:
            controller._control.trip(Fault.EMERGENCY_STOP, 'meanwhile')
            stopped.wait(0.5)  # some of the loop's periods
        else:
            stopped.set()
        publish(status)
        reported.append(status.text)

    monkeypatch.setattr(controller, '_publish_stop', publish_slowly)
    bench.ask('cancel')
    bench.wait(lambda: len(reported) == 2, 'both reports')
    assert reported == ['canceled by ~/cancel', 'meanwhile']
