"""ControllerRates: how often the controller does what need not be done in every period."""

from __future__ import annotations

from typing import Final

from robots_controller.controller import ControllerState

PROGRESS_RATE: Final = 25.0  # Hz
# Feedback tells that the robot is alive and follows; looking more often only costs time, but at the end of a
# motion, which waits until the robot stands.
FEEDBACK_RATE: Final = 50.0  # Hz
SETTLING_RATE: Final = 250.0  # Hz


class ControllerRates:
    """Cycles of the controller in which something is due.

    Args:
        rate: Cycles per second, Hz.
    """

    def __init__(self, rate: float) -> None:
        self.progress_every = cycles(rate, PROGRESS_RATE)
        """Progress is told each so many cycles."""
        self.feedback_every = cycles(rate, FEEDBACK_RATE)
        """The feedback is looked at each so many cycles, or more often."""
        self._settling_every = cycles(rate, SETTLING_RATE)

    def feedback_due(self, cycle: int, state: ControllerState) -> bool:
        """The controller looks at the feedback in this cycle."""
        if cycle % self.feedback_every == 0:
            return True
        return state is ControllerState.SETTLING and cycle % self._settling_every == 0


def cycles(rate: float, times: float) -> int:
    """Cycles of a loop (Hz) between two of what is done so many times a second, at least 1."""
    return max(1, round(rate / times))
