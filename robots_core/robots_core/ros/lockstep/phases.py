"""Phase: the order of things within one instant of simulated time."""

from enum import IntEnum
from typing import Final

NANOSECONDS: Final = 1_000_000_000
"""Per second."""

START: Final = NANOSECONDS
"""First instant, ns; a stamp of 0 would mean none."""

NEVER: Final = 2**63 - 1
"""Time of what is not planned, ns."""


class Phase(IntEnum):
    """A turn of an instant; each begins when all messages of those before it have been handled."""

    ENVIRONMENT = 0
    """Sensors, bridges to a PLC, bag players."""
    CUEING = 1
    """What makes references of the sensors' messages, such as those that move a cabin."""
    GUIDANCE = 2
    """Streams of references made from what the sensors measured, or from a jog command."""
    CONTROL = 3
    """The controller."""
    DRIVES = 4
    """The drives."""
    OBSERVE = 5
    """Whatever observes the robot: collision watch, kinematics, health; a PLC at the end of its cycle."""
    PLANNING = 6
    """Planners, when all commands of a program's turn have come."""
    PROGRAM = 7
    """Robot programs; planners and programs have turns until none has anything to do at this instant."""
