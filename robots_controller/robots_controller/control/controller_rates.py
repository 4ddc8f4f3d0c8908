"""ControllerRates: how often the controller does what need not be done in every period."""

from typing import Final

from robots_controller.control.controller import Controller, ControllerState
from robots_core.periodic.watchdog import CHECKS

PROGRESS_RATE: Final = 25.0  # Hz
# Feedback shows that the robot is alive and, while it moves, that it follows; looking more often only costs
# time, but at the end of a motion, which waits until the robot stands.
HOLDING_RATE: Final = 10.0  # Hz
FEEDBACK_RATE: Final = 50.0  # Hz
SETTLING_RATE: Final = 250.0  # Hz
# In the time after which feedback counts as lost: one check may be late, and its message too.
CHECKS_PER_TIMEOUT: Final = 4.0
# Where a period is short, the time in which a sleeping processor wakes up is a notable part of it.
AWAKE_RATE: Final = 500.0  # Hz


class ControllerRates:
    """Cycles of the controller in which something is due.

    Args:
        rate: Cycles per second, Hz.
        feedback_timeout: Older feedback counts as lost, s; feedback is checked more often than that.
    """

    def __init__(self, rate: float, feedback_timeout: float) -> None:
        self.progress_every = cycles(rate, PROGRESS_RATE)
        """Progress is reported each so many cycles."""
        # The rarer ones are multiples of this.
        least = CHECKS_PER_TIMEOUT / feedback_timeout
        self._settling_every = cycles(rate, max(SETTLING_RATE, least))
        checks = rate / self._settling_every
        self._feedback_every = self._settling_every * cycles(checks, max(FEEDBACK_RATE, least))
        self.holding_every = self._settling_every * cycles(checks, max(HOLDING_RATE, least))
        """The feedback of a robot that stands is checked each so many cycles."""
        self.look_every = cycles(rate, CHECKS / feedback_timeout)
        """The watchdog of the feedback looks at least each so many cycles."""

    def feedback_due(self, cycle: int, controller: Controller) -> bool:
        """The controller checks the feedback in this cycle."""
        # Most cycles are done with at the first condition.
        return cycle % self._settling_every == 0 and cycle % self.feedback_every(controller) == 0

    def feedback_every(self, controller: Controller) -> int:
        """The controller checks the feedback each so many cycles, as long as its state stays."""
        state = controller.state
        if state is ControllerState.SETTLING:
            return self._settling_every
        return self.holding_every if state is ControllerState.HOLDING else self._feedback_every


def cycles(rate: float, times: float) -> int:
    """Cycles of a loop (Hz) between two of what is done so many times a second, at least 1."""
    return max(1, round(rate / times))


def idle_latency_for(rate: float) -> float:
    """Idle latency that a loop of this rate (Hz) requests by default, s; negative for none."""
    return 0.0 if rate >= AWAKE_RATE else -1.0
