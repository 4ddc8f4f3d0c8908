# ruff: noqa: PLR0917, C901  # compiled loops over arrays
"""The fastest path speed by dynamic programming, compiled: reachable speeds backwards, the fastest forwards.

A limit k at grid point i is |a x + b u + c| <= bound with u = s_dot^2 and x = s_ddot.
"""

from __future__ import annotations

import numpy as np

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

# Coefficients of x below this fraction of the largest one at a point bound u alone (zero-inertia point).
NO_INERTIA = 1e-9
FASTEST = 1e18  # s_dot^2 without limits
SEARCH_STEPS = 40
SEARCH_END = 1e-7  # of u
PASSES = 3  # the first with constant x from point to point, the others with the slopes of the one before
# Fraction of the margin of a limit at rest that the change of x within an interval may use.
SLOPE_PART = 0.5


@compiled()
def fastest_speeds(s: Array, rows: Array, highest: Array, scale: Array, u: Array, change: Array) -> int:
    """Fill the highest squared path speed u (m,), to rest, and how x changes within intervals.

    Shin and McKay 1986, in the form of Pham and Pham 2018: a backward pass finds from which speeds the end
    can be reached inside the limits, a forward pass takes the fastest of them. From point to point x is
    linear in s with a given change, and kept inside the limits of both points. The change is first 0 and
    then the slope of the accelerations found, limited as in schemes for conservation laws (van Leer 1977):
    this makes the error fall with the square of the step, without oscillations where a limit has almost no
    coefficient of x.

    Args:
        s: Path grid, (m,), increasing.
        rows: (m, k, 3): a, b and c of every limit, divided by it.
        highest: Largest u that velocity limits allow, (m,).
        scale: Part of the limits to use, (m,).
        u: Filled, (m,); the first is given and stays, 0 for rest; 0 at the end.
        change: Filled, (m - 1,): x at the end of an interval less x at its begin.

    Returns:
        -1, or the first grid point at which the robot cannot even hold still.
    """
    m = rows.shape[0]
    return _passes(s, rows, highest, scale, np.empty(m), np.empty(m), u, change)


@compiled(nrt=False)
def _passes(
    s: Array, rows: Array, highest: Array, scale: Array, summit: Array, top: Array, u: Array, change: Array
) -> int:
    """`fastest_speeds` with memory for the highest allowed and the highest reachable speeds, (m,) each."""
    m = rows.shape[0]
    for i in range(m):
        summit[i] = _highest_speed(rows[i], highest[i], scale[i])
        if summit[i] < 0.0:
            return i
    change[:] = 0.0
    for number in range(PASSES):
        if number > 0:
            _slopes(s, rows, scale, u, change)
        top[m - 1] = 0.0
        for i in range(m - 2, -1, -1):
            step = s[i + 1] - s[i]
            ends = (rows[i], rows[i + 1])
            top[i] = min(_reachable(step, ends, (scale[i], scale[i + 1]), change[i], top[i + 1]), summit[i])
        for i in range(m - 1):
            step = s[i + 1] - s[i]
            ends = (rows[i], rows[i + 1])
            u[i + 1] = _following(step, ends, (scale[i], scale[i + 1]), change[i], u[i], top[i + 1])
    return -1


@compiled(nrt=False)
def _highest_speed(rows: Array, highest: float, scale: float) -> float:
    """Largest u for which some x keeps all limits (maximum velocity curve), -1 if not even u = 0."""
    largest = 0.0
    for k in range(rows.shape[0]):
        largest = max(largest, abs(rows[k, 0]))
    u = min(highest, FASTEST)
    for k in range(rows.shape[0]):
        a, b, c = rows[k, 0], rows[k, 1], rows[k, 2]
        # Standing still, u = x = 0, must be allowed; with lowered limits it is assumed to be.
        if abs(c) > 1.0:
            return -1.0
        if abs(a) <= NO_INERTIA * largest and b != 0.0:
            bound = max(scale, abs(c))
            u = min(u, (bound - c if b > 0.0 else bound + c) / abs(b))
    # Newton's method on the excess of the lowest x over the highest, a convex function of u.
    for _ in range(4 * rows.shape[0]):
        low, high = -np.inf, np.inf
        low_slope = high_slope = 0.0
        for k in range(rows.shape[0]):
            a = rows[k, 0]
            if abs(a) <= NO_INERTIA * largest:
                continue
            slope, center = rows[k, 1] / a, rows[k, 2] / a
            half = max(scale, abs(rows[k, 2])) / abs(a)
            value = center + slope * u
            if -half - value > low:
                low, low_slope = -half - value, -slope
            if half - value < high:
                high, high_slope = half - value, -slope
        if low <= high or low_slope <= high_slope:
            break
        u = max(u - (low - high) / (low_slope - high_slope), 0.0)
    return u


@compiled(nrt=False)
def _slopes(s: Array, rows: Array, scale: Array, u: Array, change: Array) -> None:
    """Fill the change of x within every interval, from the mean x of its neighbours."""
    m = s.size
    for i in range(m - 1):
        change[i] = 0.0
        if i == 0 or i == m - 2:
            continue
        x = 0.5 * (u[i + 1] - u[i]) / (s[i + 1] - s[i])
        before = 0.5 * (u[i] - u[i - 1]) / (s[i] - s[i - 1])
        after = 0.5 * (u[i + 2] - u[i + 1]) / (s[i + 2] - s[i + 1])
        left = (x - before) / (s[i + 1] - s[i - 1])
        right = (after - x) / (s[i + 2] - s[i])
        if left * right <= 0.0:
            continue
        # Per interval: the mean slope, or twice the smaller one beside a jump.
        size = min(2.0 * abs(left), 2.0 * abs(right), 0.5 * abs(left + right))
        size *= 2.0 * (s[i + 1] - s[i])
        for end in range(2):
            for k in range(rows.shape[1]):
                a, c = abs(rows[i + end, k, 0]), abs(rows[i + end, k, 2])
                room = 2.0 * SLOPE_PART * max(scale[i + end] - c, 0.0)
                if a * size > room:
                    size = room / a
        change[i] = size if left > 0.0 else -size


@compiled(nrt=False)
def _reachable(
    step: float, ends: tuple[Array, Array], scales: tuple[float, float], change: float, top: float
) -> float:
    """Largest u from which some next u of at most `top` is reached, 0 if there is none."""
    high = top
    for _ in range(SEARCH_STEPS):
        high_u, slope, gap, closing = _latest(step, ends, scales, change, high)
        if gap <= 0.0:
            break
        # Newton's method on the gap, a convex function of the next u: it never overshoots from above.
        if closing <= 0.0:
            return 0.0
        high -= (1.0 + SEARCH_END) * gap / closing
        if high < 0.0:
            return 0.0
    if slope >= 0.0:
        return max(high_u, 0.0)
    # More speed at the next point allows less here: u is a concave, piecewise linear function of it, with its
    # maximum where a rising and a falling line meet.
    low = 0.0
    low_u, low_slope, gap, _ = _latest(step, ends, scales, change, low)
    if gap > 0.0:
        return high_u
    for _ in range(SEARCH_STEPS):
        if low_slope <= 0.0 or high - low <= SEARCH_END * top:
            break
        middle = low + (high_u - low_u - slope * (high - low)) / (low_slope - slope)
        meeting = low_u + low_slope * (middle - low)
        middle_u, middle_slope, _, _ = _latest(step, ends, scales, change, middle)
        if middle_slope > 0.0:
            low, low_u, low_slope = middle, middle_u, middle_slope
        else:
            high, high_u, slope = middle, middle_u, middle_slope
        if middle_u >= meeting * (1.0 - SEARCH_END):
            break
    return max(low_u, high_u)


@compiled(nrt=False)
def _latest(
    step: float, ends: tuple[Array, Array], scales: tuple[float, float], change: float, following: float
) -> tuple[float, float, float, float]:
    """Largest u inside the upper limits from which `following` is reached, and its slope over `following`.

    Also the gap by which the smallest u inside the lower limits, 0 or more, exceeds it, and the slope of that
    gap: `following` is not reachable if the gap is above 0.
    """
    low, high = 0.0, np.inf
    inverse = 0.5 / step
    high_slope, low_slope = 1.0, 0.0
    for end in range(2):
        rows, scale = ends[end], scales[end]
        shift = (end - 0.5) * change
        for k in range(rows.shape[0]):
            a, b, c = rows[k, 0], rows[k, 1], rows[k, 2]
            bound = max(scale, abs(c))
            # a (x + shift) + b u_end + c with x = (following - u) inverse
            gain = b * (1 - end) - a * inverse
            rate = b * end + a * inverse
            offset = a * shift + c + rate * following
            if gain == 0.0:
                if abs(offset) > bound:
                    return -1.0, 0.0, abs(offset) - bound, rate if offset > 0.0 else -rate
                continue
            part = 1.0 / gain
            center, half = -offset * part, bound * abs(part)
            if center - half > low:
                low, low_slope = center - half, -rate * part
            if center + half < high:
                high, high_slope = center + half, -rate * part
    return high, high_slope, low - high, low_slope - high_slope


@compiled(nrt=False)
def _following(
    step: float,
    ends: tuple[Array, Array],
    scales: tuple[float, float],
    change: float,
    u: float,
    top: float,
) -> float:
    """Largest next u, at most `top`, that is reached from u."""
    high = top
    inverse = 0.5 / step
    for end in range(2):
        rows, scale = ends[end], scales[end]
        shift = (end - 0.5) * change
        for k in range(rows.shape[0]):
            a, b, c = rows[k, 0], rows[k, 1], rows[k, 2]
            bound = max(scale, abs(c))
            gain = b * end + a * inverse
            offset = a * shift + c + (b * (1 - end) - a * inverse) * u
            if gain > 0.0:
                high = min(high, (bound - offset) / gain)
            elif gain < 0.0:
                high = min(high, (-bound - offset) / gain)
    return max(high, 0.0)
