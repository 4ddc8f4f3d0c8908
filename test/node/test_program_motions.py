"""Programs with the nodes of planner, controller and drives: interrupts, aborts and stops reach the robot.

What the motions are like is judged in test/unit/test_interrupted_motions.py, on a simulated clock.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.parameter import Parameter
from std_msgs.msg import UInt8MultiArray
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_from_message
from robots_core.ros.qos import COMMAND, STATE
from robots_planning.nodes.planning_node import PlanningNode

from .bench import EVERY_STATE, Bench

ROBOT = 'kuka_kr210_r2700'
PATIENT = 20.0  # s, with drives that a busy machine delays
MOVE = 'ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)\n'
TARGET = [20, -80, 80, 0, 60, 0]
# The motion takes minutes until an input lets it go fast: no machine comes too late for what happens on it.
CRAWL = 'setOverride(0.002)\n'


class Cell(Bench):
    """Everything from the program to the drives, in one process."""

    def __init__(self, runner: Any, folder: Path) -> None:
        super().__init__(runner)
        self.folder = folder
        self.references = self.collect('joint_reference', JointTrajectory, read=lambda m: m.points[0])
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.status = self.collect('program_status', DiagnosticStatus, EVERY_STATE, diagnostic_values)
        self.outputs = self.collect(
            'digital_outputs', UInt8MultiArray, EVERY_STATE, lambda message: list(message.data)
        )
        self.start_node(DriveNode, robot_model=ROBOT)
        self.start_node(ControllerNode, robot_model=ROBOT, feedback_timeout=PATIENT)
        self.program = self.start_node(LuaProgramNode, robot_model=ROBOT)
        planner = self.start_node(PlanningNode, robot_model=ROBOT)
        self.wait(lambda: self.references and planner._reference is not None, 'the robot')

    def command(self, name: str) -> None:
        response = self.call(f'lua_program_node/{name}')
        assert response.success, response.message

    def start(self, text: str) -> None:
        path = self.folder / 'test.lua'
        path.write_text(text)
        (result,) = self.program.set_parameters([Parameter('program', value=str(path))])
        assert result.successful
        self.command('open')
        self.command('run')

    def until_moving(self) -> None:
        self.wait(lambda: any(self.references[-1].velocities), 'it moves')

    def until_standing(self) -> list[float]:
        """Wait until the robot stands; returns where, deg."""
        self.wait(lambda: not any(self.references[-1].velocities), 'it stands')
        return np.degrees(self.references[-1].positions).tolist()

    def end(self, state: str) -> None:
        self.wait(lambda: self.status and self.status[-1]['state'] in (state, 'FAILED'), 'its end')
        assert self.status[-1]['state'] == state, self.status[-1]

    def set_input(self, value: int) -> None:
        self.publish('digital_inputs', UInt8MultiArray(data=[value]), STATE)


@pytest.fixture
def cell(ros_nodes: Any, tmp_path: Path) -> Cell:
    return Cell(ros_nodes, tmp_path)


def test_an_input_interrupts_the_motion_which_then_goes_on(cell: Cell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() setDigitalOutput(1, 1)'
        ' while getDigitalInput(1) do wait(0.01) end setOverride(1) end)\n' + CRAWL + MOVE
    )
    cell.until_moving()
    cell.set_input(1)
    cell.wait(lambda: cell.outputs[-1][0] == 1, 'the handler')
    cell.until_standing()
    assert not cell.results
    cell.set_input(0)
    cell.end('FINISHED')
    cell.wait(lambda: [result.message for result in cell.results] == ['reached'], 'the result')
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-9)


def test_a_handler_that_aborts_ends_the_motion(cell: Cell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() setOverride(1) return "abort" end)\n'
        + CRAWL
        + 'ptpJointSpaceAngles(60, -60, 70, 0, 60, 0)\n'
        + MOVE
    )
    cell.until_moving()
    cell.set_input(1)
    cell.end('FINISHED')
    cell.wait(lambda: [result.ok for result in cell.results] == [False, True], 'the results')
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-9)


def test_a_stop_leaves_the_robot_on_its_path_and_the_program_runs_again(cell: Cell) -> None:
    cell.start('if getDigitalInput(1) then setOverride(1) else setOverride(0.002) end\n' + MOVE)
    cell.until_moving()
    cell.command('stop')
    cell.end('STOPPED')
    cell.wait(lambda: [result.ok for result in cell.results] == [False], 'the result')
    assert cell.until_standing()[0] < TARGET[0] - 1.0
    cell.set_input(1)
    cell.command('run')
    cell.end('FINISHED')
    np.testing.assert_allclose(cell.until_standing(), TARGET, atol=1e-9)
