"""The nodes of a cell without its pendant, and what they report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from trajectory_msgs.msg import JointTrajectory

from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_from_message
from robots_core.ros.qos import COMMAND
from robots_core.validation import Array
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = 'kuka_kr210_r2700'
PAGE = {'robot_model': ROBOT, 'port': 0, 'connection_timeout': 60.0}
"""Parameters of a pendant."""


class Cell:
    """In mode T1; both threads of a test may look."""

    def __init__(self, runner: Any, folder: Path) -> None:
        self.runner, self.folder = runner, folder
        self.references: list[Any] = []
        self.results: list[MotionResult] = []
        self.pages: list[str] = []
        self.node = peer = runner.create_node('peer')
        peer.create_subscription(
            JointTrajectory, 'joint_reference', lambda m: self.references.append(m.points[0]), 10_000
        )
        peer.create_subscription(
            DiagnosticStatus,
            'motion_result',
            lambda message: self.results.append(motion_result_from_message(message)),
            COMMAND.depth,
        )
        peer.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, 100)
        for kind in (LuaProgramNode, PlanningNode):
            runner.add(kind(**runner.options(robot_model=ROBOT)))
        runner.add(DriveNode(**runner.options(robot_model=ROBOT, **SPARSE)))
        options = {'robot_model': ROBOT, 'operating_mode': 'T1', **LATE_DRIVES, **SPARSE}
        runner.add(ControllerNode(**runner.options(**options)))

    def _on_health(self, message: DiagnosticArray) -> None:
        found = [one for one in message.status if one.name == '/pendant_node']
        self.pages += filter(None, [diagnostic_values(one).get('url', '') for one in found])

    @property
    def moving(self) -> bool:
        return bool(self.references) and any(self.references[-1].velocities)

    @property
    def q(self) -> Array:
        return np.array(self.references[-1].positions)
