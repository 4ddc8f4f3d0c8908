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
    GUIDANCE = 1
    """Streams of references made from what the sensors measured, or from a jog command."""
    CONTROL = 2
    """The controller."""
    DRIVES = 3
    """The drives."""
    OBSERVE = 4
    """Whatever looks at the robot: collision watch, kinematics, health; a PLC at the end of its cycle."""
    PLANNING = 5
    """Planners, when all commands of a program's turn have come."""
    PROGRAM = 6
    """Robot programs; planners and programs have turns until none has anything to do at this instant."""
