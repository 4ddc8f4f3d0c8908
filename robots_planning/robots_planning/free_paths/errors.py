"""Why there is no motion around obstacles."""

from robots_core.errors import PlanningError


class NoFreePathError(PlanningError):
    """The search has found no path within its budget, which does not mean that there is none."""

    code = 'R305'
    remedy = 'Command an intermediate point, or a larger budget of the search (`docs/how_to/collisions.md`).'


class SearchCancelledError(PlanningError):
    """The motion was given up while its path was searched for."""

    code = 'R306'
    remedy = 'None is needed: its commander has given the motion up.'


class BlockedPostureError(PlanningError):
    """Start or target is in contact with something, or closer to it than the margin."""

    code = 'R307'
    remedy = 'Jog the robot away from the contact, or choose another target or configuration.'
