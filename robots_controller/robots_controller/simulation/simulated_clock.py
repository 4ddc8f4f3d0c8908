"""SimulatedClock: the time of a simulated cell."""

from typing import Final

from robots_controller.program.turn_clock import NANOSECONDS, TurnClock

START: Final = NANOSECONDS  # ns; a stamp of zero means "none" in ROS


class SimulatedClock(TurnClock):
    """A clock that the cell sets."""

    def __init__(self) -> None:
        super().__init__(lambda: self.stamp)
        self.nanoseconds = 0
        """Time since the start of the simulation; the cell sets it."""

    def now(self) -> float:
        """Time in seconds."""
        return (START + self.nanoseconds) / NANOSECONDS

    @property
    def stamp(self) -> int:
        """Time in nanoseconds, `START` at the start of the simulation."""
        return START + self.nanoseconds

    @property
    def elapsed(self) -> float:
        """Seconds since the start of the simulation."""
        return self.nanoseconds / NANOSECONDS
