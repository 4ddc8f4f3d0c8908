"""controller_node and drive_node together, over real topics."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.duration import Duration
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from late_drives import PATIENT
from robots_controller.control.stops.faults import Fault
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.ports import trajectory_intake
from robots_core import load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import (
    diagnostic_values,
    doubles,
    id_stamp,
    motion_result_from_message,
    motion_result_message,
    stamp_id,
)
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.qos import COMMAND, SENSOR, STATE
from robots_core.ros.timed_node import TimedNode
from robots_core.status import Level, Status

from .bench import EVERY_STATE, Bench

ROBOT = load_robot_model('kuka_kr210_r2700')
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)
AWAY = HOME + np.array([0.2, 0.1, -0.1, 0.3, 0.2, 0.1])
FAST_DRIVES = {'bandwidth': [40.0]}
# One process runs the test too, which no thread may push aside.
OPTIONS = {'robot_model': 'kuka_kr210_r2700', 'realtime_priority': 0}
STANDING = 50  # references that are the same
CRAWL = 0.02  # override: no machine comes too late for what happens on the way


class ControllerBench(Bench):
    """A controller with its drive; the test sends trajectories."""

    def __init__(
        self,
        runner: Any,
        *,
        feedback_timeout: float = PATIENT,
        watchdog: float = PATIENT,
        controller: Mapping[str, Any] = MappingProxyType({}),
        operating_mode: str = 'AUTOMATIC',
        **drives: Any,
    ) -> None:
        super().__init__(runner, 'planner')
        self.newest_reference = 0.0  # s
        self.newest_state = 0.0  # s
        self.references = self.collect('joint_reference', JointTrajectory, read=self._reference)
        self.positions = self.collect('joint_states', JointState, read=self._state)
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.progress = self.collect('motion_progress', Float64, read=lambda message: message.data)
        self.drive = self.start_node(DriveNode, **OPTIONS, **(drives or FAST_DRIVES))
        self.controller = self.start_node(
            ControllerNode,
            **OPTIONS,
            feedback_timeout=feedback_timeout,
            watchdog=watchdog,
            operating_mode=operating_mode,
            **controller,
        )
        self.trajectories = self.publisher('joint_trajectory', JointTrajectory)
        self.wait(lambda: self.references, 'first reference')

    def _reference(self, message: JointTrajectory) -> np.ndarray:
        self.newest_reference = float(stamp_id(message.header.stamp))
        return np.array(message.points[0].positions)

    def _state(self, message: JointState) -> np.ndarray:
        self.newest_state = float(stamp_id(message.header.stamp))
        return np.array(message.position)

    def override(self, value: float) -> None:
        self.publish('override', Float64(data=value), STATE)
        self.wait(lambda: self.controller._controller.speed.override == value, 'the override')

    def send_slowly(self, goal: np.ndarray, duration: float = 1.0) -> str:
        """Send a motion that crawls until the override is 1 again, and wait until it moves."""
        self.override(CRAWL)
        id_ = self.send(HOME, goal, duration)
        self.wait(lambda: np.any(self.references[-1] != HOME), 'a moving robot')
        return id_

    def stamp(self) -> str:
        """The id of a motion that is commanded now."""
        return stamp_id(self.peer.get_clock().now().to_msg())

    def send(
        self,
        start: np.ndarray,
        goal: np.ndarray,
        duration: float = 1.0,
        names: list[str] | None = None,
        id_: str = '',
    ) -> str:
        """Send a minimum-jerk motion, stamped now if it has no id; returns its id."""
        zero = doubles(np.zeros(start.size))
        message = JointTrajectory(joint_names=names or NAMES)
        message.header.stamp = id_stamp(id_ or self.stamp())
        for time, q in ((0.0, start), (duration, goal)):
            point = JointTrajectoryPoint(positions=doubles(q), velocities=zero, accelerations=zero)
            point.time_from_start.sec, point.time_from_start.nanosec = int(time), int(1e9 * (time % 1))
            message.points.append(point)
        self.trajectories.publish(message)
        return stamp_id(message.header.stamp)

    def result(self) -> MotionResult:
        self.wait(lambda: self.results, 'motion_result')
        # On a busy machine the last references and states come after it.
        now = 1e-9 * self.peer.get_clock().now().nanoseconds
        self.wait(lambda: self.newest_reference >= now, 'the references until now')
        if self.drive._loop.alive:
            self.wait(lambda: self.newest_state >= now, 'the states until now')
        return self.results.pop(0)

    def ask(self, service: str) -> None:
        assert self.call(f'controller_node/{service}').success

    def until_standing(self) -> None:
        count = len(self.references)
        self.wait(
            lambda: (
                len(self.references) > count + STANDING
                and np.ptp(self.references[-STANDING:], axis=0).max() == 0.0
            ),
            'a standing robot',
        )


@pytest.fixture
def bench(ros_nodes: Any) -> ControllerBench:
    return ControllerBench(ros_nodes)


def test_follows_a_trajectory_and_tells_when_the_robot_stands_there(bench: ControllerBench) -> None:
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
        reason = 'stopped before a collision, without a way around: canceled by ~/cancel'
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


def test_a_motion_of_a_program_that_is_lost_does_not_begin(
    ros_nodes: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trajectory_intake, 'GIVEN_UP_AFTER', 1e3)  # s: no machine is too slow for it
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
    monkeypatch.setattr(trajectory_intake, 'GIVEN_UP_AFTER', 1e3)  # s: no machine is too slow for it
    bench = ControllerBench(ros_nodes, watchdog=1.0)
    planner = ros_nodes.add(TimedNode('planning_node', context=ros_nodes.context))
    heartbeat = Heartbeat(planner)
    bench.wait(lambda: 'planning_node' not in bench.controller.watch.unseen, 'its heartbeat')
    commanded = bench.stamp()
    heartbeat.stop()
    bench.wait(lambda: bench.controller.watch.lost, 'the loss')
    if when == 'when it is back':
        heartbeat = Heartbeat(planner)
        bench.wait(lambda: not bench.controller.watch.lost, 'its return')
    bench.send(HOME, AWAY, id_=commanded)  # as a planner that was frozen right before it sent this
    result = bench.result()
    assert not result.ok
    assert result.message.startswith('given up: no sign of life of planning_node')
    np.testing.assert_array_equal(bench.references[-1], HOME)
    bench.results.clear()
    bench.send(HOME, AWAY)  # commanded since
    assert bench.result().ok
    heartbeat.stop()


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


def test_a_motion_that_was_sent_before_the_controller_was_held_up_is_refused(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes)
    before = bench.references[-1]

    def hold_up() -> None:  # in the executor's thread, so that nothing is served meanwhile
        bench.send(HOME, AWAY)
        assert bench.trajectories.wait_for_all_acked(Duration(seconds=10.0))
        bench.controller.held_up(60.0 * PATIENT)

    once = bench.peer.create_guard_condition(hold_up)
    once.trigger()
    result = bench.result()
    assert not result.ok
    assert result.message == 'controller_node was held up after this was commanded; command it again'
    np.testing.assert_array_equal(bench.references[-1], before)
    bench.send(HOME, AWAY)
    assert bench.result().ok


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
