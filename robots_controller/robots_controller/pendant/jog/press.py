"""Press: a button that acts only while it is held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

DEADLINE: Final = 0.2  # s between two signs of one press, after which it has ended


@dataclass
class Press:
    """One press of a button, as a stream of signs that it is still held.

    Nothing is repeated for the browser: without its signs no command is sent, and the planner's timeout stops
    the robot. A press whose stream was interrupted has ended for good: what arrives late does not move the
    robot again.

    Attributes:
        number: Counts the presses of a page.
        key: What is pressed.
        last: Time of the last sign, s.
        over: It has ended.
        moves: It has commanded a motion to a target, not a jog.
    """

    number: int
    key: str
    last: float
    over: bool = False
    moves: bool = False

    def hold(self, now: float) -> bool:
        """Take a sign that the button is held, at a time (s); False once the press has ended."""
        self.over = self.over or now - self.last > DEADLINE
        self.last = now
        return not self.over
