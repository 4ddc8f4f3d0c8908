"""LimitUse and AxisExtremes: how much of a limit a trajectory uses, at most and axis by axis."""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array


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


class AxisExtremes(NamedTuple):
    """The largest use of a limit on each axis.

    Attributes:
        ratio: Value over limit, (n,); for position 1 at a bound, 0 in the middle of the range.
        value: (n,), SI.
        limit: (n,), SI.
        time: When, (n,) s.
    """

    ratio: Array
    value: Array
    limit: Array
    time: Array

    @classmethod
    def of(cls, limit: Array, *parts: tuple[Array, Array]) -> Self:
        """Of samples in parts.

        Args:
            limit: (n,).
            parts: Each times, (k,) or (k, n), s, and values, (k, n); at least the first has some.
        """
        value, time = _largest(*parts)
        return cls(value / limit, value, limit, time)

    @classmethod
    def of_positions(cls, axes: AxesData, *parts: tuple[Array, Array]) -> Self:
        """Of positions, whose limits are the ends of each axis's range; parts as for `of`."""
        highest, when_highest = _largest(*parts)
        lowest, when_lowest = _largest(*((t, -q) for t, q in parts))
        middle, half = axes.middle_and_half
        above, below = (highest - middle) / half, (middle + lowest) / half
        high = above >= below
        return cls(
            np.where(high, above, below),
            np.where(high, highest, -lowest),
            np.where(high, axes.upper, axes.lower),
            np.where(high, when_highest, when_lowest),
        )

    def worst(self, quantity: str, axes: AxesData) -> LimitUse:
        """The use of the limit on the axis that uses most of it."""
        axis = int(self.ratio.argmax())
        return LimitUse(
            quantity=quantity,
            ratio=float(self.ratio[axis]),
            joint=axes.names[axis],
            time=float(self.time[axis]),
            value=float(self.value[axis]),
            limit=float(self.limit[axis]),
            unit=axes.unit(axis, quantity),
        )


def _largest(*parts: tuple[Array, Array]) -> tuple[Array, Array]:
    """The largest value of each axis and its time, (n,) each."""
    columns = np.arange(parts[0][1].shape[1])
    found = []
    for t, values in parts:
        if len(values):
            rows = values.argmax(axis=0)  # takes an eighth of the time of max(axis=0)
            found.append((values[rows, columns], t[rows] if t.ndim == 1 else t[rows, columns]))
    value, time = found[0]
    for other, when in found[1:]:
        value, time = np.where(other > value, other, value), np.where(other > value, when, time)
    return value, time
