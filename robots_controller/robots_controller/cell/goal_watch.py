"""GoalWatch: gives up the goal of a driver's action that is not answered, served or executed."""

import math
from typing import Final

ANSWER_PATIENCE: Final = 2.0  # s, for the answer to a goal, and for joint_states while it runs


class GoalWatch:
    """Watches the newest goal of an action."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._asked = math.inf  # s, since when the goal has no answer
        self._received: tuple[object, float] = None, math.inf  # the newest feedback, and since when, s
        self.executed = False
        """The driver has accepted the goal, and it has not ended."""

    def sent(self, now: float) -> None:
        """A goal was sent, at a time in s."""
        self._asked, self.executed = now, False

    def answered(self, *, accepted: bool) -> None:
        """The driver has answered."""
        self._asked, self.executed = math.inf, accepted

    def ended(self) -> None:
        """The goal has ended, or was given up."""
        self.answered(accepted=False)

    def measured(self, newest: object, now: float) -> None:
        """Take the newest feedback of the robot at a time, s; the same object is no new one."""
        if newest is not self._received[0]:
            self._received = newest, now

    def problem(self, now: float, *, served: bool) -> str:
        """Why the goal must be given up at a time, s, if the action is served or not; '' if it need not."""
        if now - self._asked > ANSWER_PATIENCE:
            return f'{self._name} has not answered for {ANSWER_PATIENCE:g} s'
        if self.executed and not served:
            return f'{self._name} is not served any more'
        if self.executed and now - self._received[1] > ANSWER_PATIENCE:
            return f'no joint_states for {ANSWER_PATIENCE:g} s while the robot moves'
        return ''
