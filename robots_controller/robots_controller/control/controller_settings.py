"""ControllerSettings: how the controller works."""

from dataclasses import dataclass

from robots_core.periodic.watchdog import WATCHDOG
from robots_core.validation import positive


@dataclass(frozen=True, kw_only=True)
class ControllerSettings:
    """How the controller works.

    Attributes:
        period: Time between two references, s.
        smoothing_time: Window of the moving average, s; 0 switches it off.
        ramp_time: Shortest time from standstill to full path speed after pause or override, s.
        feedback_timeout: Feedback older than this is lost, s.
        goal_tolerance: The robot stands at its target when every axis is this close, rad (m).
        settling_time: Longest time from the end of the reference until it stands there, s.
        following_error: Largest distance of an axis to its reference, rad (m).
        stream_timeout: A stream of single points is stale without one for this long, s.

    Raises:
        InvalidInputError: a value that is not a positive, finite number.
    """

    period: float = 0.004
    smoothing_time: float = 0.02
    ramp_time: float = 0.2
    feedback_timeout: float = WATCHDOG
    goal_tolerance: float = 1e-5
    settling_time: float = 3.0
    following_error: float = 0.5
    stream_timeout: float = 0.1

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value != 0.0 or name != 'smoothing_time':
                positive(value, name)


def checked_speed_limit(limit: float) -> float:
    """A limit of the speed of the tool, m/s, or 0 for none.

    Raises:
        InvalidInputError: another one.
    """
    return 0.0 if limit == 0.0 else positive(limit, 'tool_speed_limit', 'm/s')
