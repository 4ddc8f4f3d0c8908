"""DriverGoals: when a driver gets a goal of its action, and which ends of goals stop the robot."""

import math
from collections.abc import Callable
from typing import Final, Literal

ANSWER_PATIENCE: Final = 2.0  # s, for the answer to a goal
ERRORS: Final = {
    -1: 'invalid goal',
    -2: 'invalid joints',
    -3: 'old time stamp',
    -4: 'path tolerance violated',
    -5: 'goal tolerance violated',
}
TOLERANCES: Final = {-4, -5}


class DriverGoals:
    """Goals of control_msgs/FollowJointTrajectory, of which each takes the place of the one before.

    Args:
        name: Of the action.
        failed: Called with the reason, for a person, when the driver refuses a goal, ends it, does not answer
            or is gone; again and again while that holds.
    """

    def __init__(self, name: str, failed: Callable[[str], None]) -> None:
        self._name, self._failed = name, failed
        self._sent: object = None
        self._runs = False  # the newest goal was accepted, and has neither ended nor been canceled
        self._asked = math.inf  # s, since when the newest goal has no answer
        self.number = 0
        """Of the newest goal."""
        self.served = False
        """The driver has served the action."""

    def due(self, wanted: object, now: float, *, served: bool) -> Literal['send', 'cancel', '']:
        """What to do at a time, s: send `wanted` as the goal with the next number, or cancel the newest goal.

        Args:
            wanted: The trajectory that the driver is to execute; None for none.
            now: Time, s.
            served: The driver serves the action.
        """
        if not served:
            if self.served:
                self._failed(f'{self._name} is not served any more')
            return ''
        self.served = True
        if now - self._asked > ANSWER_PATIENCE:
            self._failed(f'{self._name} has not answered for {ANSWER_PATIENCE:g} s')
        if wanted is None:
            runs, self._sent, self._runs = self._runs, None, False
            return 'cancel' if runs else ''
        if wanted == self._sent:  # it stands there, or moves there
            return ''
        self.number += 1
        self._sent, self._asked = wanted, min(self._asked, now)
        return 'send'

    def answered(self, number: int, *, accepted: bool) -> None:
        """The driver has answered a goal."""
        self._asked = math.inf
        if not accepted:
            self._fail(f'{self._name} has refused a goal')
        elif number == self.number:
            self._runs = True

    def ended(self, number: int, *, succeeded: bool, code: int, text: str) -> None:
        """A goal has ended; the ends of those that were replaced matter only if a tolerance was violated."""
        newest = number == self.number
        if newest:
            canceled, self._runs = not self._runs, False
            if canceled:
                return
        if not succeeded and (newest or code in TOLERANCES):
            self._fail(f'{self._name} has ended a goal: {ERRORS.get(code, f"code {code}")}: {text}')

    def _fail(self, reason: str) -> None:
        self._sent, self._runs = None, False
        self._failed(reason)
