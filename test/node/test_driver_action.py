"""A robot behind the FollowJointTrajectory of a driver, which the test stands in for."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from bench import Bench
from control_interfaces import control_msgs
from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.cell_interface.driver_file import Driver, DriverActionSettings, read_driver
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.nodes.hardware_node import HardwareNode
from robots_core.ros.messages import doubles, motion_result_from_message
from robots_core.ros.qos import COMMAND, STATE
from robots_planning.nodes.planning_node import PlanningNode
from trajectory_controller_double import TrajectoryControllerDouble

from .trajectory_action_double import NAME, TrajectoryActionDouble

__all__ = ['control_msgs']

ROBOT = load_robot_model('ur5e')
NAMES = list(ROBOT.axes_data.names)
DRIVER = f'action: {{name: {NAME}}}\njoint_states: /driver/joint_states\nlead: 0.3\n'


class DrivenBench(Bench):
    """Planner, controller and hardware_node before a driver, all from the command to the robot."""

    def __init__(self, runner: Any, action: Any, folder: Path) -> None:
        super().__init__(runner)
        (folder / 'driver.yaml').write_text(DRIVER)
        self.controller = TrajectoryControllerDouble(NAMES, np.array(ROBOT.home))
        self.driver = TrajectoryActionDouble(self.peer, action, self.controller)
        self.running = self.collect('robot_running', Bool, STATE, lambda message: message.data)
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.node = self.start_node(
            HardwareNode,
            robot_model='ur5e',
            driver=str(folder / 'driver.yaml'),
            realtime_priority=0,
            **SPARSE,
        )
        measured = self.publisher('/driver/joint_states', JointState)
        self.peer.create_timer(0.01, lambda: measured.publish(self._measured()))
        self.start_node(ControllerNode, robot_model='ur5e', **LATE_DRIVES, **SPARSE)
        planner = self.start_node(PlanningNode, robot_model='ur5e')
        self.publisher('ptpjoint_joint', JointState, COMMAND)
        self.wait(lambda: planner.reference() is not None and self.driver.goals, 'goals')

    def _measured(self) -> JointState:
        position, velocity = self.controller.step(self.driver.now())
        return JointState(name=NAMES, position=doubles(position), velocity=doubles(velocity))

    @property
    def q(self) -> np.ndarray:
        """Where the robot is."""
        return self.controller.step(self.driver.now())[0]

    def move(self, target: np.ndarray) -> None:
        """Command a motion; its result comes later."""
        self.results.clear()
        self.publish('ptpjoint_joint', JointState(name=NAMES, position=doubles(target)), COMMAND)

    def result(self) -> Any:
        """The result of the motion."""
        return self.wait(lambda: self.results and self.results[-1], 'the result')

    def until_moving(self) -> None:
        """Wait until the robot moves."""
        self.wait(lambda: np.abs(self.controller.step(self.driver.now())[1]).max() > 1e-3, 'it moves')

    def reset(self) -> None:
        """Permit motion again once the robot follows."""
        self.wait(lambda: self.running[-1], 'the robot follows')
        self.wait(lambda: self.call('controller_node/reset', Trigger.Request(), Trigger).success, 'the reset')


@pytest.fixture(scope='module')
def bench(module_ros_nodes: Any, control_msgs: None, tmp_path_factory: pytest.TempPathFactory) -> DrivenBench:
    del control_msgs
    from control_msgs.action import FollowJointTrajectory  # noqa: PLC0415  # built by the fixture

    return DrivenBench(module_ros_nodes, FollowJointTrajectory, tmp_path_factory.mktemp('driver'))


def test_motions_reach_their_targets_and_goals_end_when_the_robot_stands(bench: DrivenBench) -> None:
    target = np.array(ROBOT.home) + 0.2
    bench.move(target)
    assert bench.result().ok, bench.result()
    bench.wait(lambda: np.abs(bench.q - target).max() < 1e-3, 'the target')
    assert bench.driver.rejected == []
    bench.wait(lambda: not bench.driver.busy, 'the end of the last goal')
    goals = bench.driver.goals
    bench.move(np.array(ROBOT.home))
    assert bench.result().ok
    assert bench.driver.goals > goals


def test_a_tolerance_that_is_violated_is_a_fault_that_a_reset_ends(bench: DrivenBench) -> None:
    bench.move(np.array(ROBOT.home) + np.eye(6)[0] * 1.5)
    bench.until_moving()
    bench.driver.abort(-4, 'shoulder_pan_joint is 0.2 rad away')
    result = bench.result()
    assert not result.ok
    assert 'the robot has stopped by itself' in result.message
    bench.wait(
        lambda: any('path tolerance violated: shoulder_pan_joint' in one.message for one in bench.health),
        'the reason',
    )
    bench.reset()
    bench.move(np.array(ROBOT.home))
    assert bench.result().ok, bench.result()


def test_a_goal_that_is_refused_is_a_fault_as_long_as_goals_are_refused(bench: DrivenBench) -> None:
    bench.driver.refuses = True
    bench.move(np.array(ROBOT.home) + 0.3)
    assert not bench.result().ok
    bench.wait(lambda: any(f'{NAME} has refused a goal' in one.message for one in bench.health), 'the reason')
    bench.driver.refuses = False
    bench.reset()
    bench.move(np.array(ROBOT.home) + 0.1)
    assert bench.result().ok, bench.result()


def test_a_driver_that_is_gone_is_a_fault(bench: DrivenBench) -> None:
    bench.driver.server.destroy()
    bench.wait(lambda: not bench.running[-1], 'the fault')
    bench.wait(lambda: any('is not served any more' in one.message for one in bench.health), 'the reason')


def test_without_control_msgs_the_driver_is_refused(
    ros_nodes: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, 'control_msgs.action', None)
    (tmp_path / 'driver.yaml').write_text(DRIVER)
    with pytest.raises(RobotsError, match='control_msgs, which is not installed'):
        Bench(ros_nodes).start_node(
            HardwareNode, robot_model='ur5e', driver=str(tmp_path / 'driver.yaml'), realtime_priority=0
        )


@pytest.mark.parametrize(
    ('text', 'complaint'),
    [
        ('action: {name: follow}\n', 'driver.yaml:1: name is .follow., and must be a whole'),
        ('action: {name: /a, period: 0.2}\n', 'lead is 0.1 s, and must be above the period of the action'),
        ('action: {name: /a}\ntrajectory: /b\n', 'driver.yaml:2: either the topic .* or the'),
        ('action: {name: /a, rate: 3}\n', 'rate'),
    ],
)
def test_an_action_that_is_not_valid_is_refused(text: str, complaint: str, tmp_path: Path) -> None:
    (tmp_path / 'driver.yaml').write_text(text)
    with pytest.raises(InvalidInputError, match=complaint):
        read_driver(tmp_path / 'driver.yaml')


def test_an_action_has_a_longer_lead(tmp_path: Path) -> None:
    (tmp_path / 'driver.yaml').write_text('action: {name: /a}\n')
    assert read_driver(tmp_path / 'driver.yaml') == Driver(lead=0.1, action=DriverActionSettings('/a', 0.05))
