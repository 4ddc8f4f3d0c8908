"""Robot programs before a driver of motion primitives that the test plays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool

from control_interfaces import control_msgs
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.errors import RobotsError
from robots_core.ros.messages import doubles
from robots_core.ros.qos import SENSOR, STATE

from .lua_bench import LuaBench
from .primitive_action_double import NAME, PrimitiveActionDouble
from .program_cell import ROBOT

__all__ = ['control_msgs']

MOVE = 'ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)'
DRIVER = f'primitives: {{name: {NAME}, frame: base_link}}\nrunning: /driver/running\n'


def driver_file(folder: Path, text: str = DRIVER) -> str:
    path = folder / 'driver.yaml'
    path.write_text(text)
    return str(path)


class DrivenBench(LuaBench):
    """lua_program_node before a driver that the test plays."""

    def __init__(self, runner: Any, folder: Path, action: Any) -> None:
        super().__init__(runner, folder, planner=False, driver=driver_file(folder))
        self.driver = PrimitiveActionDouble(self.peer, action)
        states = self.publisher('joint_states', JointState, SENSOR)
        message = JointState(
            name=list(self.node.robot.axes_data.names), position=doubles(self.node.robot.home)
        )
        self.measures = True
        self.peer.create_timer(0.02, lambda: states.publish(message) if self.measures else None)
        self.wait(self.node._feedback.newest, 'the first feedback')

    def start(self, text: str) -> None:
        self.driver.goals.clear()
        super().start(text)

    def until_goal(self) -> Any:
        """The sequence of the program that was started."""
        return self.wait(lambda: self.driver.goals and self.driver.goals[-1], 'a goal')


@pytest.fixture(scope='module')
def bench(module_ros_nodes: Any, control_msgs: None, tmp_path_factory: pytest.TempPathFactory) -> DrivenBench:
    del control_msgs
    from control_msgs.action import ExecuteMotionPrimitiveSequence  # noqa: PLC0415  # built by the fixture

    return DrivenBench(module_ros_nodes, tmp_path_factory.mktemp('played'), ExecuteMotionPrimitiveSequence)


def test_a_line_is_sent_with_its_pose_and_speeds(bench: DrivenBench) -> None:
    bench.start('setSpeed(1, 0.2)\nlinearRelative(0, 0, -0.1, 0, 0, 0)')
    (line,) = bench.until_goal()
    assert (line.type, line.blend_radius, list(line.joint_positions)) == (50, 0.0, [])
    assert {one.name: one.value for one in line.additional_arguments}['velocity'] == pytest.approx(0.2)
    (pose,) = line.poses
    r, _ = bench.node.robot.direct_kinematics(bench.node.robot.home)
    assert pose.header.frame_id == 'base_link'
    assert pose.pose.position.z == pytest.approx(r[2] - 0.1)
    bench.driver.end()
    bench.wait_for_state('FINISHED')


def test_a_stop_cancels_the_goal(bench: DrivenBench) -> None:
    bench.start(MOVE)
    bench.until_goal()
    canceled = bench.driver.canceled
    assert bench.ask('stop').success
    bench.wait_for_state('STOPPED')
    bench.wait(lambda: bench.driver.canceled == canceled + 1, 'the cancellation')


@pytest.mark.parametrize(
    ('outcome', 'reason'),
    [
        (('abort', -1, 'protective stop'), f'{NAME} has ended the motion: protective stop'),
        (('abort', -3, ''), f'{NAME} has ended the motion: code -3'),
        (('succeed', -2, ''), f'{NAME} has ended the motion: code -2'),
    ],
)
def test_a_goal_that_fails_ends_the_program(bench: DrivenBench, outcome: Any, reason: str) -> None:
    bench.start(MOVE)
    bench.until_goal()
    bench.driver.end(*outcome)
    assert reason in bench.wait_for_state('FAILED')['error']


def test_a_goal_that_is_refused_ends_the_program(bench: DrivenBench) -> None:
    bench.driver.refuses = True
    bench.start(MOVE)
    assert f'{NAME} has refused the motion' in bench.wait_for_state('FAILED')['error']
    bench.driver.refuses = False


def test_a_robot_that_stops_by_itself_ends_the_program(bench: DrivenBench) -> None:
    bench.publish('/driver/running', Bool(data=True), STATE)
    bench.start(MOVE)
    bench.until_goal()
    bench.publish('/driver/running', Bool(data=False), STATE)
    assert 'the robot has stopped by itself' in bench.wait_for_state('FAILED')['error']
    refused = bench.ask('run')
    assert not refused.success
    assert 'programs run again when /driver/running is true' in refused.message
    bench.driver.goals.clear()
    bench.publish('/driver/running', Bool(data=True), STATE)
    bench.wait(lambda: bench.ask('run').success, 'a program that runs again')
    bench.until_goal()
    bench.driver.end()
    bench.wait_for_state('FINISHED')


def test_a_robot_that_measures_nothing_any_more_ends_the_program(bench: DrivenBench) -> None:
    bench.start(MOVE)
    bench.until_goal()
    bench.measures = False
    assert 'no joint_states for 2 s while the robot moves' in bench.wait_for_state('FAILED')['error']
    bench.wait(lambda: not bench.driver.busy, 'the end of its goal')
    bench.measures = True


def test_nobody_guides_such_a_robot(bench: DrivenBench) -> None:
    bench.start('followReference(1)')
    assert 'takes motion primitives, and cannot be guided' in bench.wait_for_state('FAILED')['error']


def test_the_end_of_the_node_cancels_the_goal(ros_nodes: Any, control_msgs: None, tmp_path: Path) -> None:
    del control_msgs
    from control_msgs.action import ExecuteMotionPrimitiveSequence  # noqa: PLC0415  # built by the fixture

    bench = DrivenBench(ros_nodes, tmp_path, ExecuteMotionPrimitiveSequence)
    bench.start(MOVE)
    bench.until_goal()
    bench.wait(lambda: bench.node._motions.planner._driver._handle, 'that the goal is accepted')
    ros_nodes.destroy(bench.node)
    bench.wait(lambda: bench.driver.canceled, 'the cancellation')


def test_a_driver_that_is_gone_ends_the_program(bench: DrivenBench) -> None:
    bench.start(MOVE)
    bench.until_goal()
    bench.driver.server.destroy()
    error = bench.wait_for_state('FAILED')['error']
    assert f'{NAME} is not served any more' in error


@pytest.mark.parametrize(
    ('text', 'complaint'),
    [
        ('running: /driver/running\n', 'names no `primitives`'),
        ('primitives: {name: /a}\njoint_states: /other/joint_states\n', 'and must be /joint_states'),
        ('primitives: {name: a}\n', 'must be a whole topic name'),
        ('primitives: {name: /a}\nlead: 0.1\n', 'lead is of drivers that take trajectories'),
    ],
)
def test_a_driver_file_that_does_not_do_is_refused(
    ros_nodes: Any, control_msgs: None, tmp_path: Path, text: str, complaint: str
) -> None:
    del control_msgs
    options = ros_nodes.options(robot_model=ROBOT, driver=driver_file(tmp_path, text))
    with pytest.raises(RobotsError, match=complaint):
        LuaProgramNode(**options)
