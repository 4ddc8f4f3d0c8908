"""Program, planner, controller and drives: their nodes in one process."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.parameter import Parameter
from std_msgs.msg import UInt8MultiArray
from trajectory_msgs.msg import JointTrajectory

from bench import EVERY_STATE, Bench
from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_from_message, nanoseconds
from robots_core.ros.qos import COMMAND, STATE
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = 'kuka_kr210_r2700'
MOVE = 'ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)\n'
TARGET = [20, -80, 80, 0, 60, 0]  # deg
# The motion takes minutes until something lets it go fast: no machine comes too late for what happens on it.
CRAWL = 'setOverride(0.002)\n'


class ProgramCell(Bench):
    """Everything from the program to the drives, in one process.

    Args:
        runner: Spins all.
        folder: Of the program.
        driver: Driver file of a robot that takes primitives; '' for the planner and the controller.
        controller: Parameters of controller_node.
    """

    def __init__(self, runner: Any, folder: Path, *, driver: str = '', **controller: Any) -> None:
        super().__init__(runner)
        self.folder = folder
        self._stamp = 0  # ns, of the newest reference that was collected
        self.references = self.collect('joint_reference', JointTrajectory, read=self._read)
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.status = self.collect('program_status', DiagnosticStatus, EVERY_STATE, diagnostic_values)
        self.outputs = self.collect(
            'digital_outputs', UInt8MultiArray, EVERY_STATE, lambda message: list(message.data)
        )
        self.start_node(DriveNode, robot_model=ROBOT, **SPARSE)
        options = {'robot_model': ROBOT, **LATE_DRIVES, **SPARSE, **controller}
        self.controller = self.start_node(ControllerNode, **options)
        self.program = self.start_node(LuaProgramNode, robot_model=ROBOT, driver=driver)
        self.planner = self.start_node(PlanningNode, robot_model=ROBOT)
        self.wait(lambda: self.references and self.planner.reference() is not None, 'the robot')

    def _read(self, message: JointTrajectory) -> Any:
        self._stamp = nanoseconds(message.header.stamp)
        return message.points[0]

    def command(self, name: str) -> None:
        response = self.call(f'lua_program_node/{name}')
        assert response.success, response.message

    def open(self, text: str) -> None:
        path = self.folder / 'test.lua'
        path.write_text(text)
        (result,) = self.program.set_parameters([Parameter('program', value=str(path))])
        assert result.successful
        self.command('open')

    def start(self, text: str) -> None:
        self.open(text)
        self.command('run')

    def until_moving(self) -> None:
        self.wait(lambda: any(self.references[-1].velocities), 'it moves')

    def until_standing(self) -> list[float]:
        """Wait until the robot stands, from now on; returns where, deg."""
        now = self.peer.get_clock().now().nanoseconds
        self.wait(lambda: self._stamp >= now and not any(self.references[-1].velocities), 'it stands')
        return np.degrees(self.references[-1].positions).tolist()

    def end(self, state: str) -> None:
        self.wait(lambda: self.status and self.status[-1]['state'] in (state, 'FAILED'), 'its end')
        assert self.status[-1]['state'] == state, self.status[-1]

    def set_input(self, value: int) -> None:
        self.publish('digital_inputs', UInt8MultiArray(data=[value]), STATE)
