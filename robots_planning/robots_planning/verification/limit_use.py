"""LimitUse: how much of a limit a trajectory uses."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LimitUse:
    """The worst use of one kind of limit.

    Attributes:
        quantity: 'position', 'velocity', 'acceleration', 'jerk', 'torque', or 'speed' or 'angular speed' of
            a tool.
        ratio: Value over limit; for position 1 at a bound, 0 in the middle of the range.
        joint: Where; 'the tool' for the speeds of a tool.
        time: When, s.
        value: SI.
        limit: The bound, SI.
        unit: Of both.
    """

    quantity: str
    ratio: float
    joint: str
    time: float
    value: float
    limit: float
    unit: str

    def describe(self) -> str:
        """One line for a person."""
        return (
            f'{self.joint} {self.quantity} {self.value:.6g} {self.unit} at {self.time:.3f} s passes its '
            f'limit {self.limit:.6g} {self.unit} ({100.0 * self.ratio:.2f} %)'
        )
