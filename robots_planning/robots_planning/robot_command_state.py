"""RobotCommandState: the main arbiter between robot program and path planning (paper, section 4.3)."""

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType
from typing import Final

from robots_core.blocks.following.guide import Guide


class RobotCommandState(StrEnum):
    """What the robot is commanded to do; set by the program, back to IDLE at the end of a motion."""

    IDLE = 'IDLE'
    PTPJOINT_CARTESIAN = 'PTPJOINT_CARTESIAN'
    PTPJOINT_JOINT = 'PTPJOINT_JOINT'
    PTPCARTESIAN = 'PTPCARTESIAN'
    TRAJECTORY = 'TRAJECTORY'
    TEACH = 'TEACH'


STATE_OF_GUIDE: Final[Mapping[Guide, RobotCommandState]] = MappingProxyType(
    {
        Guide.NONE: RobotCommandState.IDLE,
        Guide.SENSOR: RobotCommandState.TRAJECTORY,
        Guide.PERSON: RobotCommandState.TEACH,
    }
)
