"""RobotCommandState: the main arbiter between robot program and path planning (paper, section 4.3)."""

from enum import StrEnum


class RobotCommandState(StrEnum):
    """What the robot is commanded to do; set by the program, back to IDLE at the end of a motion."""

    IDLE = 'IDLE'
    PTPJOINT_CARTESIAN = 'PTPJOINT_CARTESIAN'
    PTPJOINT_JOINT = 'PTPJOINT_JOINT'
    PTPCARTESIAN = 'PTPCARTESIAN'
    TRAJECTORY = 'TRAJECTORY'
    TEACH = 'TEACH'
