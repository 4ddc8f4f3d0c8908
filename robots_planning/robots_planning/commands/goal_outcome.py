"""Outcome: the answer to the goal of an action that moves the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from robots_core.errors import JointNamesError, RobotsError

# Error codes of control_msgs; the first two are those of all its actions of motions.
SUCCESSFUL: Final = 0
INVALID_GOAL: Final = -1
INVALID_JOINTS: Final = -2
PATH_TOLERANCE_VIOLATED: Final = -4
GOAL_TOLERANCE_VIOLATED: Final = -5


@dataclass(frozen=True)
class Outcome:
    """The answer to a goal.

    Attributes:
        code: The action's error code.
        message: For a person.
        canceled: It ended because its client asked for that.
    """

    code: int
    message: str
    canceled: bool = False

    @classmethod
    def refused(cls, error: RobotsError) -> Outcome:
        """Of a goal that is not begun."""
        return cls(INVALID_JOINTS if isinstance(error, JointNamesError) else INVALID_GOAL, error.message)


PREEMPTED: Final = Outcome(INVALID_GOAL, 'preempted by a newer goal')
CANCELED: Final = Outcome(SUCCESSFUL, 'canceled', canceled=True)
