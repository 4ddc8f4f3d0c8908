"""What strangers publish beside the nodes that move the robot is dropped, and they are named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from late_drives import LATE_DRIVES
from robots_controller.nodes.controller import watched_nodes
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core import load_robot_model
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.lockstep.counted_endpoints import NeverExecuted
from robots_core.ros.messages import (
    BUILD,
    doubles,
    motion_result_from_message,
    motion_result_message,
    stamp_id,
)
from robots_core.ros.peers.identified_messages import IdentifiedMessages
from robots_core.ros.qos import COMMAND, STATE
from robots_planning.nodes.planning_node import PlanningNode

NAME = 'kuka_kr210_r2700'
ROBOT = load_robot_model(NAME)
NAMES = list(ROBOT.axes_data.names)
HOME = np.array(ROBOT.home)
GOAL = HOME + 0.3
CRAWL = 0.002  # override: the motion continues until it is raised


class Cell(Bench):
    """Planner, controller and drives, and a stranger."""

    def __init__(self, runner: Any) -> None:
        super().__init__(runner)
        self.drive = self.start_node(DriveNode, robot_model=NAME, realtime_priority=0)
        self.controller = self.start_node(
            ControllerNode, robot_model=NAME, realtime_priority=0, **LATE_DRIVES
        )
        self.planner = self.start_node(PlanningNode, robot_model=NAME)
        self.stranger = runner.create_node('stranger')
        self.positions = self.collect(
            'joint_states', JointState, read=lambda message: np.array(message.position)
        )
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.wait(lambda: self.positions, 'joint_states')

    def move_slowly(self) -> str:
        """Begin a motion to the goal that lasts until the override is raised."""
        self.publish('override', Float64(data=CRAWL), STATE)
        self.wait(lambda: self.controller._controller.speed.override == CRAWL, 'the override')
        self.wait(lambda: self.planner.reference() is not None, 'the first reference')
        message = BUILD.joint_state(self.peer.get_clock().now().to_msg(), NAMES, GOAL)
        self.publish('ptpjoint_joint', message)
        self.wait(lambda: self.planner.moving, 'a motion')
        self.wait(lambda: np.any(self.positions[-1] != HOME), 'a moving robot')
        return stamp_id(message.header.stamp)

    def until_named(self, node: str, topic: str, forged: Any, qos: Any = COMMAND) -> Any:
        """Let the stranger publish until a node names it; returns its publisher."""
        publisher = self.stranger.create_publisher(type(forged), topic, qos)
        text = f'/stranger publishes {topic} beside '

        def named() -> bool:
            publisher.publish(forged)
            return any(
                one.name == node and one.level != DiagnosticStatus.OK and text in one.message
                for one in self.health
            )

        self.wait(named, f'{node} names the stranger')
        return publisher


def test_messages_come_with_the_identity_that_the_graph_has(ros_nodes: Any) -> None:
    taker = ros_nodes.create_node('taker')
    subscription = taker.create_subscription(
        Float64, 'number', lambda _: None, 10, callback_group=NeverExecuted(), raw=True
    )
    messages = IdentifiedMessages(subscription)
    assert messages.take() is None
    senders = [ros_nodes.create_node(f'sender_{k}') for k in range(2)]
    publishers = [sender.create_publisher(Float64, 'number', 10) for sender in senders]
    ros_nodes.wait_for(lambda: all(one.get_subscription_count() for one in publishers))
    for k, publisher in enumerate(publishers):
        publisher.publish(Float64(data=float(k)))
    found = [ros_nodes.wait_for(messages.take) for _ in publishers]
    names = {bytes(one.endpoint_gid): one.node_name for one in taker.get_publishers_info_by_topic('number')}
    assert {names[identity] for _, identity in found} == {'sender_0', 'sender_1'}


def test_strangers_do_not_disturb_a_motion_and_are_named(ros_nodes: Any) -> None:
    cell = Cell(ros_nodes)
    id_ = cell.move_slowly()
    elsewhere = JointTrajectory(joint_names=NAMES, points=[JointTrajectoryPoint(positions=doubles(HOME))])
    for node, topic, forged in (
        ('/planning_node', 'motion_result', motion_result_message(MotionResult(id_, True, 'reached'), NAME)),
        ('/controller_node', 'joint_trajectory', elsewhere),
        ('/controller_node', 'joint_states', JointState(name=NAMES, position=doubles(HOME + 0.6))),
    ):
        cell.until_named(node, topic, forged)
    assert cell.planner.planner.holds(id_)  # the forged result ended nothing
    cell.publish('override', Float64(data=1.0), STATE)

    def ends() -> list[MotionResult]:  # the forged ones have no duration
        return [result for result in cell.results if 'duration' in result.details]

    cell.wait(ends, 'the end of the motion')
    assert [(result.id, result.ok) for result in ends()] == [(id_, True)]
    # The feedback behind the result may still be on its way to the test.
    cell.wait(lambda: np.abs(cell.positions[-1] - GOAL).max() < 0.02, 'the goal in joint_states')


def test_a_forged_commander_or_mode_does_not_let_strangers_move_the_robot(ros_nodes: Any) -> None:
    cell = Cell(ros_nodes)
    assert cell.call('controller_node/commander/program', SetBool.Request(data=True), SetBool).success
    commanders = cell.planner.admission.commanders
    cell.wait(lambda: commanders.commander is Commander.PROGRAM, 'the commander at the planner')
    for topic, forged in (('commander', 'REMOTE'), ('operating_mode', 'REMOTE')):
        cell.until_named('/planning_node', topic, String(data=forged), STATE)
    assert commanders.commander is Commander.PROGRAM
    assert commanders.mode is OperatingMode.AUTOMATIC
    orders = cell.stranger.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
    cell.wait(orders.get_subscription_count, 'the planner listens')
    orders.publish(BUILD.joint_state(cell.peer.get_clock().now().to_msg(), NAMES, GOAL))
    cell.wait(lambda: cell.results, 'the refusal')
    assert cell.results[0].message.startswith('PROGRAM commands the robot, not REMOTE')


def test_a_controller_that_is_started_again_is_heard_at_once(ros_nodes: Any) -> None:
    cell = Cell(ros_nodes)
    commanders = cell.planner.admission.commanders
    assert cell.call('controller_node/commander/program', SetBool.Request(data=True), SetBool).success
    cell.wait(lambda: commanders.commander is Commander.PROGRAM, 'the commander at the planner')
    ros_nodes.destroy(cell.controller)
    cell.start_node(ControllerNode, robot_model=NAME, **LATE_DRIVES)
    cell.wait(lambda: commanders.commander is Commander.NOBODY, 'the commander of the new controller')


def test_a_forged_run_or_guide_does_not_reach_program_and_guide(ros_nodes: Any) -> None:
    bench = Cell(ros_nodes)
    bench.start_node(LuaProgramNode, robot_model=NAME)
    bench.until_named('/lua_program_node', 'run_enabled', Bool(data=True), STATE)
    bench.until_named('/planning_node', 'guide', String(data=Guide.SENSOR), STATE)


def test_a_stranger_at_the_drives_stops_the_robot_and_they_do_not_follow_it(ros_nodes: Any) -> None:
    cell = Cell(ros_nodes)
    forged = JointTrajectory(joint_names=NAMES, points=[JointTrajectoryPoint(positions=doubles(GOAL))])
    publisher = cell.until_named('/drive_node', 'joint_reference', forged, STATE)
    cell.until_health(DiagnosticStatus.ERROR, '/stranger publishes joint_reference')
    assert np.abs(np.array(cell.positions) - HOME).max() < 0.01
    assert '/stranger' in cell.call('controller_node/reset').message
    ros_nodes.call(lambda: cell.stranger.destroy_publisher(publisher))
    cell.wait(lambda: cell.call('controller_node/reset').success, 'a reset when the stranger is gone')


def test_a_stranger_that_cannot_be_told_apart_stops_the_robot(
    ros_nodes: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(watched_nodes, 'publishers_are_identified', lambda: False)
    cell = Cell(ros_nodes)
    publisher = cell.stranger.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
    cell.until_health(DiagnosticStatus.ERROR, '/stranger publishes joint_trajectory')
    assert '/stranger' in cell.call('controller_node/reset').message
    ros_nodes.call(lambda: cell.stranger.destroy_publisher(publisher))
    cell.wait(lambda: cell.call('controller_node/reset').success, 'a reset when the stranger is gone')


def test_anyone_may_stop_by_an_empty_trajectory(ros_nodes: Any) -> None:
    cell = Cell(ros_nodes)
    cell.move_slowly()
    publisher = cell.stranger.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
    cell.wait(publisher.get_subscription_count, 'the controller listens')
    publisher.publish(JointTrajectory())
    cell.wait(lambda: cell.results, 'the end of the motion')
    assert not cell.results[0].ok
    assert 'empty' in cell.results[0].message


@pytest.mark.parametrize('qos', [COMMAND, STATE])
def test_a_subscription_with_writers_ends_as_any(ros_nodes: Any, qos: Any) -> None:
    bench = Bench(ros_nodes)
    node, taken = bench.start_node(DriveNode, robot_model=NAME, realtime_priority=0), []
    subscription = node.create_subscription(
        JointTrajectory,
        'joint_trajectory',
        taken.append,
        qos,
        callback_group=MutuallyExclusiveCallbackGroup(),
    )
    publisher = bench.publisher('joint_trajectory', JointTrajectory, STATE)
    publisher.publish(JointTrajectory())
    bench.wait(lambda: taken, 'a message')
    ros_nodes.call(lambda: node.destroy_subscription(subscription))
    bench.wait(lambda: publisher.get_subscription_count() == 0, 'the end of the subscription')
