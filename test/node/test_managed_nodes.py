"""Managed controller and drives: what the services of lifecycle_msgs let them do, and refuse."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from late_drives import LATE_DRIVES
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.blocks.drives.supervised_drives import DriveState
from robots_core.errors import InvalidInputError
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import doubles, motion_result_from_message, stamp_id
from robots_core.ros.qos import COMMAND, STATE

NAME = 'kuka_kr210_r2700'
ROBOT = load_robot_model(NAME)
HOME = np.array(ROBOT.home)
AWAY = HOME + 0.2
CRAWL = 0.02  # override
CONFIGURE, CLEANUP = Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_CLEANUP
ACTIVATE, DEACTIVATE = Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_DEACTIVATE
NODES = ('drive_node', 'controller_node')


class ManagedBench(Bench):
    """Managed drives and controller; the test is their manager, and sends trajectories."""

    def __init__(self, runner: Any) -> None:
        super().__init__(runner, 'planner')
        self.references = self.collect('joint_reference', JointTrajectory)
        self.states = self.collect('joint_states', JointState)
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.power = self.collect('drives_on', Bool, STATE, lambda message: message.data)
        options: dict[str, Any] = {'robot_model': NAME, 'realtime_priority': 0}
        self.drive = self.start_node(DriveNode, **options, managed=True, bandwidth=[40.0])
        self.controller = self.start_node(ControllerNode, **options, managed=True, **LATE_DRIVES)
        self.trajectories = self.publisher('joint_trajectory', JointTrajectory)

    def change(self, node: str, transition: int) -> bool:
        request = ChangeState.Request(transition=Transition(id=transition))
        return bool(self.call(f'{node}/change_state', request, ChangeState).success)

    def state(self, node: str) -> str:
        return str(self.call(f'{node}/get_state', None, GetState).current_state.label)

    def activate(self) -> None:
        for node in NODES:
            assert self.change(node, CONFIGURE)
            if node == 'controller_node':
                self.wait(lambda: self.states, 'feedback')
                self.until_feedback()
            assert self.change(node, ACTIVATE)
            assert self.state(node) == 'active'
        self.until_following()

    def until_feedback(self) -> None:
        self.wait(lambda: self.controller._controller.reference is not None, 'feedback in the controller')

    def until_following(self) -> None:
        self.wait(lambda: self.drive._supervised.state is DriveState.FOLLOWING, 'open brakes')

    def send(self, goal: np.ndarray) -> str:
        """Send a minimum-jerk motion of 1 s from where the reference stands; returns its id."""
        zero = doubles(np.zeros(goal.size))
        message = JointTrajectory(joint_names=list(ROBOT.axes_data.names))
        message.header.stamp = self.peer.get_clock().now().to_msg()
        for time, q in enumerate((self.controller._controller.reference[0], goal)):
            point = JointTrajectoryPoint(positions=doubles(q), velocities=zero, accelerations=zero)
            point.time_from_start.sec = time
            message.points.append(point)
        self.trajectories.publish(message)
        return stamp_id(message.header.stamp)

    def result(self, id_: str) -> Any:
        return self.wait(lambda: [one for one in self.results if one.id == id_], f'the end of {id_}')[0]

    def override(self, value: float) -> None:
        self.publish('override', Float64(data=value), STATE)
        self.wait(lambda: self.controller._controller.speed.override == value, 'the override')


def test_managed_nodes_wait_until_they_are_activated_and_work_as_long_as_they_are(ros_nodes: Any) -> None:
    bench = ManagedBench(ros_nodes)
    bench.until_health(DiagnosticStatus.WARN, 'not active: it is managed')
    bench.until_feedback()
    refused = bench.result(bench.send(AWAY))
    assert not refused.ok
    assert 'controller_node is not active' in refused.message
    assert bench.references == []
    assert bench.drive._supervised.braked

    bench.activate()
    assert bench.result(bench.send(AWAY)).ok

    assert bench.change('controller_node', DEACTIVATE)
    bench.wait(lambda: bench.power[-1] is False, 'drives that are off')
    end, seen = 1e-9 * bench.peer.get_clock().now().nanoseconds, len(bench.states)
    bench.wait(lambda: len(bench.states) > seen + 100, 'time to pass')
    assert not [one for one in bench.references if float(stamp_id(one.header.stamp)) > end]
    assert not bench.result(bench.send(HOME)).ok

    assert bench.change('controller_node', ACTIVATE)
    bench.until_following()
    assert bench.result(bench.send(HOME)).ok
    assert bench.change('controller_node', DEACTIVATE)
    assert bench.change('controller_node', CLEANUP)
    assert bench.state('controller_node') == 'unconfigured'


def test_transitions_are_refused_while_the_robot_moves(ros_nodes: Any) -> None:
    bench = ManagedBench(ros_nodes)
    bench.activate()
    bench.override(CRAWL)
    id_ = bench.send(AWAY)
    bench.wait(lambda: np.any(np.abs(np.array(bench.states[-1].position) - HOME) > 1e-4), 'a moving robot')
    for node in NODES:
        assert not bench.change(node, DEACTIVATE)
        assert bench.state(node) == 'active'
    bench.override(1.0)
    assert bench.result(id_).ok
    # The result comes when the robot is near enough to its target, and it may settle for a while.
    for node in reversed(NODES):
        bench.wait(lambda: bench.change(node, DEACTIVATE), f'{node} of a robot that stands')  # noqa: B023


def test_a_shutdown_stops_a_moving_robot_inside_its_limits(ros_nodes: Any) -> None:
    bench = ManagedBench(ros_nodes)
    bench.activate()
    bench.override(CRAWL)
    id_ = bench.send(AWAY)
    bench.wait(lambda: np.any(np.abs(np.array(bench.states[-1].position) - HOME) > 1e-4), 'a moving robot')
    assert bench.change('controller_node', Transition.TRANSITION_ACTIVE_SHUTDOWN)
    assert bench.state('controller_node') == 'finalized'
    assert 'not active' in bench.result(id_).message
    bench.wait(lambda: bench.power[-1] is False, 'drives that are off')
    assert not bench.change('controller_node', ACTIVATE)


def test_a_controller_without_feedback_or_with_an_emergency_stop_stays_inactive(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    node = bench.start_node(ControllerNode, robot_model=NAME, realtime_priority=0, managed=True)

    def change(transition: int) -> bool:
        request = ChangeState.Request(transition=Transition(id=transition))
        return bool(bench.call('controller_node/change_state', request, ChangeState).success)

    assert change(CONFIGURE)
    assert not change(ACTIVATE)
    bench.start_node(DriveNode, robot_model=NAME, realtime_priority=0)
    bench.wait(lambda: node._controller.reference is not None, 'feedback')
    bench.publish('emergency_stop', Bool(data=True), STATE)
    bench.wait(lambda: len(node._controller.stops._causes) > 1, 'the emergency stop')
    assert not change(ACTIVATE)
    bench.publish('emergency_stop', Bool(data=False), STATE)
    bench.wait(lambda: len(node._controller.stops._causes) == 1, 'the end of the emergency stop')
    assert change(ACTIVATE)


def test_another_fault_is_still_to_be_reset(ros_nodes: Any) -> None:
    bench = ManagedBench(ros_nodes)
    bench.activate()
    assert bench.call('controller_node/emergency_stop').success
    bench.wait(lambda: bench.power[-1] is False, 'drives that are off')
    assert bench.change('controller_node', DEACTIVATE)
    assert bench.change('controller_node', ACTIVATE)
    bench.until_health(DiagnosticStatus.ERROR, 'stopped until ~/reset: emergency stop by ~/emergency_stop')
    assert bench.call('controller_node/reset').success
    bench.until_following()


def test_impossible_transitions_are_refused_and_the_node_continues(ros_nodes: Any) -> None:
    bench = ManagedBench(ros_nodes)
    events = bench.collect('drive_node/transition_event', TransitionEvent, COMMAND)
    for transition in (ACTIVATE, DEACTIVATE, CLEANUP, 77):
        assert not bench.change('drive_node', transition)
    request = ChangeState.Request(transition=Transition(label='fly'))
    assert not bench.call('drive_node/change_state', request, ChangeState).success
    assert bench.state('drive_node') == 'unconfigured'
    states = bench.call('drive_node/get_available_states', None, GetAvailableStates).available_states
    assert {'unconfigured', 'inactive', 'active', 'finalized'} <= {state.label for state in states}
    transitions = bench.call('drive_node/get_available_transitions', None, GetAvailableTransitions)
    assert 'configure' in [one.transition.label for one in transitions.available_transitions]
    assert bench.change('drive_node', CONFIGURE)
    bench.wait(lambda: State.PRIMARY_STATE_INACTIVE in [event.goal_state.id for event in events], 'the event')


def test_nodes_that_are_not_managed_work_from_their_start_and_have_no_states(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    bench.start_node(DriveNode, robot_model=NAME, realtime_priority=0)
    bench.until_health(DiagnosticStatus.OK, 'ready')
    own = f'{bench.peer.get_namespace().rstrip("/")}/drive_node'
    names = [name for name, _ in bench.peer.get_service_names_and_types()]
    assert f'{own}/get_parameters' in names
    assert f'{own}/change_state' not in names


def test_lockstep_has_no_managed_nodes(ros_nodes: Any) -> None:
    with pytest.raises(InvalidInputError, match='managed is not for lock-step'):
        Bench(ros_nodes).start_node(DriveNode, robot_model=NAME, managed=True, lockstep=True)
