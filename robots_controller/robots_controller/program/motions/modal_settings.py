"""The modal settings of a program as those of its motions."""

from collections.abc import Mapping
from typing import Any, Final

from robots_core.errors import PlanningError, RobotsError
from robots_planning.motion_settings import MotionSettings

PLANNING_NODE: Final = 'planning_node'
BLEND_ZONES: Final = ('blend_zone', 'joint_blend_zone')


def without_blend(settings: Mapping[str, object]) -> dict[str, object]:
    """The same settings of a motion that stops at its end."""
    return {**settings, **dict.fromkeys(BLEND_ZONES, 0.0)}


def motion_settings(settings: Mapping[str, object], planner: str = PLANNING_NODE) -> MotionSettings:
    """Modal settings that a program has changed, by name, as a planner would take them.

    Raises:
        PlanningError: it would refuse them.
    """
    wanted: dict[str, Any] = dict(settings)
    try:
        return MotionSettings(**wanted)
    except RobotsError as error:
        raise PlanningError(f'{planner} refuses the settings: {error}') from error
