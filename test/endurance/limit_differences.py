"""Limits of the axes by plain differences of positions, without knowing how these were made."""

from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array
from robots_planning.verification.limit_use import LimitUse

ORDERS: Final = {'velocity': 1, 'acceleration': 2, 'jerk': 3}
# What the controller's limit guard lets pass; a plan has a margin of 1e-4 inside its limits.
RELATIVE_TOLERANCE: Final = 1e-6
# An axis limit's own tolerance, rad (m).
POSITION_TOLERANCE: Final = 1e-9
# Of a position that a polynomial of fifth order gives: some units in the last place of the largest term.
ROUNDING: Final = 8.0 * np.finfo(float).eps


def limit_uses(
    axes: AxesData,
    position: Array,
    period: float,
    *,
    jerk: bool = False,
    steady: npt.NDArray[np.bool_] | None = None,
) -> list[LimitUse]:
    """The worst use of each limit, less what rounding of the positions can make of it.

    A difference of order k over k periods is a mean of the k-th derivative: where that keeps its limit all
    the time, the difference does.

    Args:
        axes: The limits.
        position: Positions at even times, (m, n), rad (m); m > 3.
        period: Time between them, s.
        jerk: Look at jerk too.
        steady: (m - 1,) whether two neighbours are one period apart; all are by default. Differences over
            others are left out.
    """
    middle, half = axes.middle_and_half
    uses = [_worst(axes, 'position', np.abs(position - middle) / half, position, period)]
    rounding = ROUNDING * np.maximum(1.0, np.abs(position).max(axis=0))
    for quantity, order in ORDERS.items():
        if quantity == 'jerk' and not jerk:
            continue
        values = np.diff(position, order, axis=0)
        if steady is not None:
            together = np.lib.stride_tricks.sliding_window_view(steady, order).all(axis=1)
            values = values * together[:, None]
        values = np.maximum(np.abs(values) - 2.0**order * rounding, 0.0) / period**order
        uses.append(_worst(axes, quantity, values / getattr(axes, quantity), values, period))
    return uses


def broken_limits(axes: AxesData, uses: list[LimitUse]) -> Iterator[str]:
    """A line for each limit that is not kept."""
    for use in uses:
        if use.quantity == 'position':
            axis = axes.names.index(use.joint)
            broken = max(axes.lower[axis] - use.value, use.value - axes.upper[axis]) > POSITION_TOLERANCE
        else:
            broken = use.ratio > 1.0 + RELATIVE_TOLERANCE
        if broken:
            yield use.describe()


def _worst(axes: AxesData, quantity: str, ratio: Array, values: Array, period: float) -> LimitUse:
    row, axis = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    if quantity == 'position':
        middle, _ = axes.middle_and_half
        limit = (axes.lower if values[row, axis] < middle[axis] else axes.upper)[axis]
    else:
        limit = getattr(axes, quantity)[axis]
    return LimitUse(
        quantity=quantity,
        ratio=float(ratio[row, axis]),
        joint=axes.names[axis],
        time=float(row * period),
        value=float(values[row, axis]),
        limit=float(limit),
        unit=axes.unit(int(axis), quantity),
    )
