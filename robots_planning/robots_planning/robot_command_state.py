"""RobotCommandState: the main arbiter between robot program and path planning (paper, section 4.3)."""

from enum import StrEnum
from typing import Final, Literal


class RobotCommandState(StrEnum):
    """What the robot is commanded to do; set by the program, back to IDLE at the end of a motion."""

    IDLE = 'IDLE'
    PTPJOINT_CARTESIAN = 'PTPJOINT_CARTESIAN'
    PTPJOINT_JOINT = 'PTPJOINT_JOINT'
    PTPCARTESIAN = 'PTPCARTESIAN'
    TRAJECTORY = 'TRAJECTORY'
    TEACH = 'TEACH'


JOINT_STATES: Final = (RobotCommandState.PTPJOINT_JOINT, RobotCommandState.PTPJOINT_CARTESIAN)
"""Those of motions in joint space."""
Shape = Literal['line', 'circle', 'spline']
"""Of a motion of the tool in state PTPCARTESIAN."""
