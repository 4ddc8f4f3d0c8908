"""Border: where a motion crosses the border of a zone."""

from dataclasses import dataclass

from robots_core.blocks.zones.zone import Zone


@dataclass(frozen=True, eq=False)
class Border:
    """A part of a motion across the border of a zone.

    Attributes:
        zone: The zone.
        start: Path time at which the robot has to stand while the border is closed, s.
        end: Path time from which on it is on the permitted side again, s.
    """

    zone: Zone
    start: float
    end: float
