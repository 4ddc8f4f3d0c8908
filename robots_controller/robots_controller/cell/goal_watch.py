"""GoalWatch: which goal of a driver's action counts, and when it is canceled or given up."""

import math
from typing import Final

ANSWER_PATIENCE: Final = 2.0  # s, for the answer to a goal, and for joint_states while it runs


class GoalWatch:
    """Watches the newest goal of an action; those before it, and one that is given up, do not count."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._number = 0  # of the newest goal
        self._asked = math.inf  # s, since when the goal has no answer
        self._received: tuple[object, float] = None, math.inf  # the newest feedback, and since when, s
        self._executed = self._canceling = False

    def sent(self, now: float) -> int:
        """A goal was sent, at a time in s; returns its number."""
        self._number += 1
        self._asked, self._executed, self._canceling = now, False, False
        return self._number

    def newest(self, number: int) -> bool:
        """The goal with this number counts."""
        return number == self._number

    def executes(self, number: int) -> bool:
        """The driver executes this goal: it has accepted it, and it has not ended."""
        return self._executed and self.newest(number)

    def answered(self, number: int, *, accepted: bool) -> bool:
        """The driver has answered; returns whether the goal is to be canceled."""
        if self.newest(number):
            self._asked, self._executed = math.inf, accepted
        return accepted and (self._canceling or not self.newest(number))

    def cancel(self) -> None:
        """The goal is canceled, or is to be once it is accepted."""
        self._canceling = True

    def ended(self) -> None:
        """The goal has ended."""
        self._asked, self._executed = math.inf, False

    def give_up(self) -> None:
        """The goal does not count any more, whatever becomes of it."""
        self.ended()
        self._number += 1

    def measured(self, newest: object, now: float) -> None:
        """Take the newest feedback of the robot at a time, s; the same object is no new one."""
        if newest is not self._received[0]:
            self._received = newest, now

    def problem(self, now: float, *, served: bool) -> str:
        """Why the goal must be given up at a time, s, if the action is served or not; '' if it need not."""
        if now - self._asked > ANSWER_PATIENCE:
            return f'{self._name} has not answered for {ANSWER_PATIENCE:g} s'
        if self._executed and not served:
            return f'{self._name} is not served any more'
        if self._executed and now - self._received[1] > ANSWER_PATIENCE:
            return f'no joint_states for {ANSWER_PATIENCE:g} s while the robot moves'
        return ''
