"""The faults that stop the robot, each with its stop category. No certified safety function."""

from enum import Enum, IntEnum
from typing import Final


class StopCategory(IntEnum):
    """How a machine is stopped, IEC 60204-1."""

    ZERO = 0
    """The drives are switched off at once: they brake, off the path."""
    ONE = 1
    """The robot stops on its path, as fast as its limits permit; then the drives are switched off."""
    TWO = 2
    """The robot stops on its path; the drives stay on."""


MOVING_ONLY: Final = 'moving only'


class Fault(Enum):
    """Something that stops the robot until it is reset.

    Attributes:
        category: How the robot stops.
        reaction: How long it may take until the stop begins.
        meaning: What has happened, for a person.
        moving_only: It counts only while the robot moves.
    """

    category: StopCategory
    reaction: str
    meaning: str
    moving_only: bool

    EMERGENCY_STOP = (
        StopCategory.ONE,
        'one period',
        'service `~/emergency_stop`, or `true` on topic `emergency_stop`; reset when that is `false` again',
    )
    EMERGENCY_STOP_INPUT = (
        StopCategory.ONE,
        'one period',
        'a digital input that `emergency_stop` names in a file of the cell; reset when it is released',
    )
    EMERGENCY_INPUTS_LOST = (
        StopCategory.ONE,
        '`watchdog`',
        'the node that publishes the inputs of `emergency_stop` gives no sign of life; reset when it is back',
    )
    STOP = (
        StopCategory.TWO,
        'one period',
        "service `~/stop`, as by the stop button of the operator's page",
    )
    ROBOT_STOPPED = (
        StopCategory.ONE,
        'one period',
        "the robot's driver does not follow, as after a protective stop; reset when it runs again",
    )
    FEEDBACK_JUMPED = (
        StopCategory.ZERO,
        'one check: 20 ms moving, 50 ms standing',
        'the feedback of an axis changes by more than the axis can move, or while the robot stands',
    )
    FEEDBACK_LOST = (
        StopCategory.ONE,
        '`feedback_timeout`',
        'no valid joint_states; reset when they are back',
    )
    FEEDBACK_FROZEN = (
        StopCategory.ONE,
        'half of `feedback_timeout`, 0.02 rad (m) away',
        'the feedback of an axis does not change while its reference moves',
    )
    FOLLOWING_ERROR = (
        StopCategory.ONE,
        'one check: 20 ms moving, 50 ms standing',
        'an axis is farther from its reference than `following_error`',
    )
    ZONE_VIOLATED = (
        StopCategory.ONE,
        'one check: 20 ms; one period when a zone is closed',
        'tool or bodies are across the border of a zone that is closed; they may move back after a reset',
    )
    OBSTACLE = (
        StopCategory.TWO,
        'one check of collision_node: 40 ms',
        'collision_node has stopped the robot before an obstacle, and the motion does not go around it',
    )
    CONTACT = (
        StopCategory.ONE,
        'one period of force control: 4 ms',
        'force control reports a force beyond its limit, contact that was not planned, or no force',
    )
    FOREIGN_WRITER = (
        StopCategory.ONE,
        '0.1 s',
        'an unauthorised node publishes what moves the robot, and cannot be ignored; reset when it is gone',
    )
    DEACTIVATED = (
        StopCategory.ONE,
        'one period',
        'a managed controller_node is not active; activating it is the reset',
    )
    CONTROLLER_LOST = (
        StopCategory.ONE,
        'see references ended',
        'controller_node has ended, and is started again, by `cell` or within a launch',
    )
    CONTROLLER_HELD_UP = (
        StopCategory.ZERO,
        'see references ended',
        'controller_node was frozen for longer than `watchdog` while the robot moved, and continues to run',
        MOVING_ONLY,
    )
    REFERENCE_REFUSED = (
        StopCategory.TWO,
        'at once',
        'the limit guard refuses a reference, and does not send it; the robot brakes off the path',
    )
    PLANNER_LOST = (
        StopCategory.TWO,
        '`watchdog`',
        'planning_node gives no sign of life while the robot moves',
        MOVING_ONLY,
    )
    PROGRAM_LOST = (
        StopCategory.TWO,
        '`watchdog`',
        'lua_program_node gives no sign of life while the robot moves',
        MOVING_ONLY,
    )
    COLLISION_GUARD_LOST = (
        StopCategory.TWO,
        '`watchdog`',
        'collision_node gives no sign of life; reset when it is back',
    )

    def __init__(self, category: StopCategory, reaction: str, meaning: str, moving: str = '') -> None:
        self.category, self.reaction, self.meaning = category, reaction, meaning
        self.moving_only = moving == MOVING_ONLY

    @property
    def label(self) -> str:
        """Its name for a person, as on `stop_status`."""
        return self.name.lower().replace('_', ' ')


LOST_NODES: Final = {
    'planning_node': Fault.PLANNER_LOST,
    'lua_program_node': Fault.PROGRAM_LOST,
    'collision_node': Fault.COLLISION_GUARD_LOST,
}
"""The fault that the loss of a node is."""
PERSISTENT: Final = (Fault.COLLISION_GUARD_LOST, Fault.EMERGENCY_INPUTS_LOST)
"""Without these nodes the robot would move unguarded: no reset before they are back."""
