"""The nodes of a cell without its pendant, and what they report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from trajectory_msgs.msg import JointTrajectory

from bench import Bench
from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_from_message
from robots_core.validation import Array
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = 'kuka_kr210_r2700'
PAGE = {'robot_model': ROBOT, 'port': 0, 'connection_timeout': 60.0}
"""Parameters of a pendant."""


class Cell(Bench):
    """In mode T1; both threads of a test may look."""

    def __init__(self, runner: Any, folder: Path) -> None:
        super().__init__(runner)
        self.folder = folder
        self.references = self.collect('joint_reference', JointTrajectory, read=lambda m: m.points[0])
        self.results = self.collect('motion_result', DiagnosticStatus, read=motion_result_from_message)
        for kind in (LuaProgramNode, PlanningNode):
            self.start_node(kind, robot_model=ROBOT)
        self.start_node(DriveNode, robot_model=ROBOT, **SPARSE)
        options = {'operating_mode': 'T1', **LATE_DRIVES, **SPARSE}
        self.start_node(ControllerNode, robot_model=ROBOT, **options)

    @property
    def pages(self) -> list[str]:
        found = [diagnostic_values(one) for one in self.health if one.name == '/pendant_node']
        return [values['url'] for values in found if values.get('url')]

    @property
    def moving(self) -> bool:
        return bool(self.references) and any(self.references[-1].velocities)

    @property
    def q(self) -> Array:
        return np.array(self.references[-1].positions)
