"""DriverStop: whether the robot of a driver has stopped by itself."""

import math
from typing import Final

FAILURE_SHOWN: Final = 1.0  # s, at least, that the robot is reported to have stopped


class DriverStop:
    """The driver's own state, and goals that it does not follow.

    A goal that fails is a stop of the robot until its brakes have closed, and for `FAILURE_SHOWN` at least.
    """

    follows = True
    """The driver says that its robot runs."""
    failure = ''
    """Why a goal has failed; '' if none has."""

    def __init__(self) -> None:
        self._failed_at = -math.inf

    @property
    def reason(self) -> str:
        """Why the robot has stopped; '' if it has not."""
        return self.failure or ('' if self.follows else 'the robot has stopped by itself')

    def fail(self, reason: str, now: float) -> bool:
        """A goal has failed, at a time in s; returns whether that is new."""
        new, self.failure, self._failed_at = reason != self.failure, reason, now
        return new

    def recover(self, now: float, *, braked: bool) -> bool:
        """End a failure that was shown long enough, if the brakes have closed; returns whether one ended."""
        if not (self.failure and braked and now - self._failed_at > FAILURE_SHOWN):
            return False
        self.failure = ''
        return True
