# ruff: noqa: PLR0917  # compiled loops over arrays
"""The fastest path speed, compiled: from where the end can be reached backwards, the fastest forwards.

A limit at a grid point is (a x + b u + c)^2 + (w u)^2 <= bound^2 with u = s_dot^2 and x = s_ddot. With w = 0
it is that of an axis, of its torque or of the tool along its path, with w > 0 of the length of a vector.
"""

from __future__ import annotations

from math import inf, sqrt

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

FASTEST = 1e18  # s_dot^2 without limits
NEWTON_STEPS = 60
# Relative rounding of the speeds that are compared.
SPEED_ROUNDING = 1e-12
# Ratio of the coefficients of two speeds below which the smaller one is rounding (zero-inertia point).
VANISHING = 1e-12
# Squares of coefficients, of limits divided by their bound, below which a limit bounds no speed: a path that
# turns by rounding alone has them, and their products would underflow.
NOTHING = 1e-200
# Fraction of a cone up to its tip, where its boundary is vertical and Newton's method fails.
TIP = 1.0 - 1e-6
# Fraction of the margin of a limit at rest that the change of x within an interval may use.
SLOPE_PART = 0.5

Ends = tuple[Array, Array]
"""Limits at both ends of an interval, (k, 4) each."""
Scales = tuple[float, float]
"""Parts of them to use."""


@compiled(counted=False)
def fastest_speeds(
    s: Array, rows: Array, highest: Array, scale: Array, rounds: int, u: Array, change: Array
) -> int:
    """Fill the highest squared path speed u (m,), to rest, and how x changes within intervals.

    Shin and McKay 1986, in the form of Pham and Pham 2018: a backward pass finds from which speeds the end
    can be reached inside the limits, a forward pass takes the fastest of them. From point to point x is
    linear in s with a given change, and kept inside the limits of both points, so that a path takes as long
    forwards as backwards. The change is first 0 and then the slope of the accelerations found, limited as in
    schemes for conservation laws (van Leer 1977): this makes the error fall with the square of the step,
    without oscillations where a limit has almost no coefficient of x.

    Args:
        s: Path grid, (m,), increasing.
        rows: (m, k, 4): a, b, c and w of every limit, divided by it.
        highest: Largest u that velocity limits allow, (m,).
        scale: Part of the limits to use, (m,).
        rounds: Of both passes; 1 for constant x in every interval.
        u: Filled, (m,); the first is given and stays, 0 for rest; 0 at the end.
        change: Filled, (m - 1,): x at the end of an interval less x at its begin.

    Returns:
        -1, or the first grid point at which the robot cannot even hold still.
    """
    m = s.size
    for i in range(m):
        for k in range(rows.shape[1]):
            # Standing still, u = x = 0, must be allowed; with lowered limits it is assumed to be.
            if abs(rows[i, k, 2]) > 1.0:
                return i
    change[:] = 0.0
    begin = u[0]
    for number in range(rounds):
        if number > 0:
            _slopes(s, rows, scale, u, change)
        u[m - 1] = 0.0
        for i in range(m - 2, -1, -1):
            ends, scales = (rows[i], rows[i + 1]), (scale[i], scale[i + 1])
            step = s[i + 1] - s[i]
            u[i] = _reachable(step, ends, scales, change[i], min(highest[i], FASTEST), u[i + 1])
        u[0] = begin
        for i in range(m - 1):
            ends, scales = (rows[i], rows[i + 1]), (scale[i], scale[i + 1])
            high = _following(s[i + 1] - s[i], ends, scales, change[i], u[i])[1]
            u[i + 1] = max(min(high, u[i + 1]), 0.0)
    return -1


@compiled(counted=False)
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


@compiled(counted=False)
def _reachable(step: float, ends: Ends, scales: Scales, change: float, highest: float, top: float) -> float:
    """Largest u from which some next u of at most `top` is reached, 0 if there is none."""
    u = _highest_speed(step, ends, scales, change, highest)
    for _ in range(NEWTON_STEPS):
        low, high, low_slope, high_slope = _following(step, ends, scales, change, u)
        if high > top:
            high, high_slope = top, 0.0
        gap, slope = low - high, low_slope - high_slope
        if gap <= SPEED_ROUNDING * (u + top):
            break
        # The gap is convex over u and at most 0 at u = 0: Newton's method converges to its largest zero from
        # above.
        if slope <= 0.0:
            return 0.0
        drop = gap / slope
        u = max(u - drop, 0.0)
        if drop <= SPEED_ROUNDING * u:
            break
    return u


@compiled(counted=False)
def _highest_speed(step: float, ends: Ends, scales: Scales, change: float, highest: float) -> float:
    """Largest u by the speed limits, and by those limits that bound it whatever the next u is."""
    inverse = 0.5 / step
    for end in range(2):
        rows = ends[end]
        for k in range(rows.shape[0]):
            a, b, c, w = rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3]
            bound = max(scales[end], abs(c))
            gain, rate = b * end + a * inverse, b * (1 - end) - a * inverse
            if w > 0.0 and end == 0:
                highest = min(highest, TIP * bound / w)
                continue
            if w > 0.0:
                bound *= TIP * sqrt(gain * gain + w * w) / w
            elif abs(gain) > VANISHING * abs(rate):
                continue
            if rate != 0.0:
                offset = (end - 0.5) * change * a + c
                highest = min(highest, max(bound - offset if rate > 0.0 else bound + offset, 0.0) / abs(rate))
    return highest


@compiled(counted=False)
def _following(
    step: float, ends: Ends, scales: Scales, change: float, u: float
) -> tuple[float, float, float, float]:
    """Lowest and highest next u, v >= 0, after u, and their slopes over u."""
    low, high, low_slope, high_slope = 0.0, inf, 0.0, 0.0
    inverse = 0.5 / step
    for end in range(2):
        rows, scale = ends[end], scales[end]
        shift = (end - 0.5) * change
        for k in range(rows.shape[0]):
            a, b, c, w = rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3]
            bound = max(scale, abs(c))
            # a (x + shift) + b u_end + c with x = (v - u) inverse
            gain, rate = b * end + a * inverse, b * (1 - end) - a * inverse
            rest = rate * u + a * shift + c
            if w == 0.0:
                if abs(gain) <= VANISHING * abs(rate) or gain == 0.0:
                    continue
                center, half, slope, steep = -rest / gain, bound / abs(gain), -rate / gain, 0.0
            else:
                square = gain * gain + w * w * end
                if square <= max(VANISHING * w * w, NOTHING):
                    continue
                aside, aside_rate = (
                    w * ((1 - end) * gain * u - end * rest),
                    w * ((1 - end) * gain - end * rate),
                )
                room = max(square * bound * bound - aside * aside, 0.0)
                center, half, slope = -gain * rest / square, sqrt(room) / square, -gain * rate / square
                steep = aside * aside_rate / (square * sqrt(room)) if room > 0.0 else inf
            if center - half > low:
                low, low_slope = center - half, slope + steep
            if center + half < high:
                high, high_slope = center + half, slope - steep
    return low, high, low_slope, high_slope
