"""What results and plans of motions say."""

from collections.abc import Mapping
from typing import Final

from robots_core.status import Status

PASSED: Final = 'passed'
"""The motion ran through to the next one."""
BLOCKED: Final = 'stopped before a collision'
"""An obstacle is ahead: the motion goes around it, or ends here."""


def plan_status(id_: str, ends: Mapping[str, float]) -> Status:
    """A plan as it travels on `motion_plan`.

    Args:
        id_: Its own.
        ends: When each of its commands ends, s of the plan, by id.
    """
    return Status('motion plan', values={'id': id_, **ends})
