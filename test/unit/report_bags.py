"""The bag that the report's tests read: waits, a joint motion, a line, inputs and outputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from robots_core import Pose, load_robot_model
from robots_planning import LinearCartesianLimited, LinearJoint

from .recorded_program import RecordedProgram

LINE_SPEED = 0.25  # m/s
WAIT = 0.4  # s, in line 5
HEARD = 0.3  # s, in line 6


def tending_bag(path: Path, *, slower: float = 1.0, hostile: str = '') -> Path:
    """A run of the KUKA KR 210; its line lasts `slower` times as long as planned."""
    robot = load_robot_model('kuka_kr210_r2700')
    run = RecordedProgram(robot)
    q = np.radians([0, -90, 45, 0, 45, 0])
    run.rest(0.2)
    run.line(2, f'ptpJointSpaceAngles(0, -90, 45, 0, 45, 0) {hostile}'.strip())
    run.move(LinearJoint(robot).generate(run.q, q))
    r, T = robot.direct_kinematics(q)
    down = Pose(r - np.array([0.0, 0.0, 0.5]), T)
    run.line(3, 'ptpCartesianSpace(down)')
    line = LinearCartesianLimited(robot, cartesian_speed=LINE_SPEED).generate(q, down)
    run.move(line, slower=slower, target=down)
    run.line(4, 'setDigitalOutput(1, 1)')
    run.outputs(1, 0)
    run.line(5, 'wait(0.4)')
    run.rest(WAIT)
    run.line(6, 'waitDigitalInput(2, 1)')
    run.inputs(0, 0)
    run.rest(HEARD)
    run.inputs(0, 1)
    run.line(7, 'print("done")')
    run.rest(0.02)
    return run.write(path)
