"""StopLatch: a stop by a fault holds until it is reset."""

from collections.abc import Mapping
from dataclasses import dataclass

from robots_controller.control.stops.faults import Fault, StopCategory
from robots_core.errors import NotNowError
from robots_core.status import Level, Status


@dataclass(frozen=True)
class StopState:
    """Whether a fault holds the robot.

    Attributes:
        fault: The fault; None if the robot may move.
        reason: What has happened, for a person.
        drives_on: The drives follow the references; otherwise they brake.
    """

    fault: Fault | None = None
    reason: str = ''
    drives_on: bool = True

    @property
    def status(self) -> Status:
        """As it travels on `stop_status`; a cancellation is no error."""
        values: dict[str, object] = {'drives': 'on' if self.drives_on else 'off'}
        if self.fault is not None:
            values |= {'fault': self.fault.label, 'category': self.fault.category.value}
        level = Level.OK if self.fault is None else Level.ERROR
        return Status('stop', self.reason or 'none', level, values)


class StopLatch:
    """The fault that stopped the robot, and the faults whose causes are still there.

    One thread changes it; any thread may read `state` and call `check_reset`.
    """

    def __init__(self) -> None:
        self.state = StopState()
        self._causes: Mapping[Fault, str] = {}  # replaced, never changed: another thread may iterate over it

    @property
    def latched(self) -> bool:
        """A fault holds the robot."""
        return self.state.fault is not None

    def trip(self, fault: Fault, reason: str, *, stands: bool = False) -> bool:
        """Latch a fault; of several the first counts, or a stricter one as long as the drives are on.

        If its cause stands, it stays until `clear`. Returns whether the robot is to be stopped for it.
        """
        if stands:
            self._causes = {**self._causes, fault: reason}
        before = self.state.fault
        if before is not None and (fault.category >= before.category or not self.state.drives_on):
            return False
        self.state = StopState(fault, reason, self.state.drives_on)
        return True

    def clear(self, fault: Fault) -> None:
        """The cause of a fault is gone; the stop stays."""
        self._causes = {one: reason for one, reason in self._causes.items() if one is not fault}

    def stands(self) -> None:
        """The stop is complete: the drives are switched off if the fault says so."""
        state = self.state
        if state.drives_on and state.fault is not None and state.fault.category < StopCategory.TWO:
            self.state = StopState(state.fault, state.reason, drives_on=False)

    def check_reset(self, excluding: Fault | None = None) -> None:
        """Check that nothing is there any more that stopped the robot.

        Args:
            excluding: A fault whose cause goes with the reset.

        Raises:
            RobotsError: something is.
        """
        if causes := [reason for fault, reason in self._causes.items() if fault is not excluding]:
            raise NotNowError(f'cannot reset: {"; ".join(causes)}')

    def reset(self) -> None:
        """Let the robot move again.

        Raises:
            RobotsError: as `check_reset`.
        """
        self.check_reset()
        self.state = StopState()
