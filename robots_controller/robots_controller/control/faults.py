"""The faults that stop the robot, each with its stop category. No certified safety function."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Final


class StopCategory(IntEnum):
    """How a machine is stopped, IEC 60204-1."""

    ZERO = 0
    """The drives are switched off at once: they brake, off the path."""
    ONE = 1
    """The robot stops on its path, as fast as its limits permit; then the drives are switched off."""
    TWO = 2
    """The robot stops on its path; the drives stay on."""


@dataclass(frozen=True)
class Fault:
    """Something that stops the robot until it is reset.

    Attributes:
        name: Short.
        category: How the robot stops.
        reaction: How long it may take until the stop begins.
        meaning: What has happened, for a person.
        moving_only: It counts only while the robot moves.
    """

    name: str
    category: StopCategory
    reaction: str
    meaning: str
    moving_only: bool = False


PLANNER_LOST: Final = Fault(
    'planner lost',
    StopCategory.TWO,
    '`watchdog`',
    'planning_node gives no sign of life while the robot moves',
    moving_only=True,
)
PROGRAM_LOST: Final = Fault(
    'program lost',
    StopCategory.TWO,
    '`watchdog`',
    'lua_program_node gives no sign of life while the robot moves',
    moving_only=True,
)
GUARD_LOST: Final = Fault(
    'collision guard lost',
    StopCategory.TWO,
    '`watchdog`',
    'collision_node gives no sign of life; reset when it is back',
)
FEEDBACK_LOST: Final = Fault(
    'feedback lost',
    StopCategory.ONE,
    '`feedback_timeout`',
    'no valid joint_states; reset when they are back',
)
FEEDBACK_FROZEN: Final = Fault(
    'feedback frozen',
    StopCategory.ONE,
    '5 looks at 50 Hz and 0.02 rad (m)',
    'the feedback of an axis does not change while its reference moves',
)
FEEDBACK_JUMPED: Final = Fault(
    'feedback jumped',
    StopCategory.ZERO,
    'one look: 20 ms moving, 50 ms standing',
    'the feedback of an axis changes by more than the axis can move, or while the robot stands',
)
FOLLOWING_ERROR: Final = Fault(
    'following error',
    StopCategory.ONE,
    'one look: 20 ms moving, 50 ms standing',
    'an axis is farther from its reference than `following_error`',
)
REFERENCE_REFUSED: Final = Fault(
    'reference refused',
    StopCategory.TWO,
    'at once',
    'the limit guard refuses a reference, and does not send it; the robot brakes off the path',
)
EMERGENCY_STOP: Final = Fault(
    'emergency stop',
    StopCategory.ONE,
    'one period',
    'service `~/emergency_stop`, or `true` on topic `emergency_stop`; reset when that is `false` again',
)
EMERGENCY_INPUT: Final = Fault(
    'emergency stop input',
    StopCategory.ONE,
    'one period',
    'a digital input that `emergency_stop` names in a file of the cell; reset when it is released',
)
CONTROLLER_LOST: Final = Fault(
    'controller lost',
    StopCategory.ONE,
    'see references ended',
    'controller_node has died, and is started again by `cell`',
)
CONTROLLER_HELD_UP: Final = Fault(
    'controller held up',
    StopCategory.ZERO,
    'see references ended',
    'controller_node was frozen for longer than `watchdog` while the robot moved, and lives on',
    moving_only=True,
)
ZONE_VIOLATED: Final = Fault(
    'zone violated',
    StopCategory.ONE,
    'one look: 20 ms; one period when a zone is closed',
    'tool or bodies are across the border of a zone that is closed; they may move back after a reset',
)
FOREIGN_WRITER: Final = Fault(
    'foreign writer',
    StopCategory.ONE,
    '0.1 s',
    'another node publishes `joint_reference` or `drives_on`; reset when it is gone',
)

FAULTS: Final = (
    EMERGENCY_STOP,
    EMERGENCY_INPUT,
    FEEDBACK_JUMPED,
    FEEDBACK_LOST,
    FEEDBACK_FROZEN,
    FOLLOWING_ERROR,
    ZONE_VIOLATED,
    FOREIGN_WRITER,
    CONTROLLER_LOST,
    CONTROLLER_HELD_UP,
    REFERENCE_REFUSED,
    PLANNER_LOST,
    PROGRAM_LOST,
    GUARD_LOST,
)
"""All that the controller stops for."""

LOST_NODES: Final = {
    'planning_node': PLANNER_LOST,
    'lua_program_node': PROGRAM_LOST,
    'collision_node': GUARD_LOST,
}
"""The fault that the loss of a node is."""
