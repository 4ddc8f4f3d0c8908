# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Two-pass algorithm: the fastest speed along a path, on a grid, compiled."""

from math import inf, sqrt

import numpy as np

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

NEWTON_STEPS = 60
# Relative rounding of the speeds that are compared.
SPEED_ROUNDING = 1e-12
# Ratio of the two coefficients of a line below which the smaller one is rounding.
VANISHING = 1e-12
# Fraction of the cone up to its tip, where its boundary is vertical and Newton's method fails.
TIP = 1.0 - 1e-6

Grid = tuple[Array, Array, Array, Array, Array]
"""s (m,), increasing; q' and q'' of the axes, (m, n); x' and x'' of the tool, (m, 6), linear first."""

MotionLimits = tuple[Array, Array, Array]
"""Velocity and acceleration of the axes, (n,) each; of the tool, (4,): speed, acceleration, angular speed and
angular acceleration, each on the norm of a vector."""


@compiled()
def two_pass(grid: Grid, limits: MotionLimits, scale: Array, speeds: Array) -> None:
    """Highest squared path speed from rest to rest under velocity and acceleration limits.

    A backward pass finds from which speeds the end can still be reached, a forward pass takes the fastest of
    them (Pham and Pham 2018). s_ddot is constant from point to point, and limits hold at both ends of every
    interval, so that a path takes as long forwards as backwards.

    Args:
        grid: See `Grid`.
        limits: See `MotionLimits`.
        scale: Part of the limits to use at each point, (m,): of accelerations, and of squared speeds.
        speeds: Filled: s_dot^2 at the grid points, (m,); 0 at both ends.
    """
    _two_pass(grid, limits, scale, speeds, np.empty(4))


@compiled(nrt=False)
def _two_pass(grid: Grid, limits: MotionLimits, scale: Array, speeds: Array, bounds: Array) -> None:
    m = speeds.size
    speeds[m - 1] = 0.0
    for i in range(m - 2, -1, -1):
        following = speeds[i + 1]
        u = _highest_speed(grid, limits, scale, i)
        for _ in range(NEWTON_STEPS):
            _following_speeds(grid, limits, scale, i, u, bounds)
            low, high = max(bounds[0], 0.0), min(bounds[1], following)
            gap = low - high
            if gap <= SPEED_ROUNDING * (u + following):
                break
            # The gap is convex over u and at most 0 at u = 0: Newton's method converges to its largest zero
            # from above.
            slope = (bounds[2] if bounds[0] > 0.0 else 0.0) - (bounds[3] if bounds[1] < following else 0.0)
            u = max(u - gap / slope, 0.0) if slope > 0.0 else 0.0
        speeds[i] = u
    speeds[0] = 0.0
    for i in range(m - 2):
        _following_speeds(grid, limits, scale, i, speeds[i], bounds)
        speeds[i + 1] = max(min(bounds[1], speeds[i + 1]), 0.0)


@compiled(nrt=False)
def _highest_speed(grid: Grid, limits: MotionLimits, scale: Array, i: int) -> float:
    """Highest s_dot^2 at point i by the speed limits and by the acceleration limits that bound it alone."""
    s, q_s, q_ss, x_s, x_ss = grid
    velocity, acceleration, tool = limits
    j, step = i + 1, 0.5 / (s[i + 1] - s[i])
    highest = inf
    for k in range(velocity.size):
        if q_s[i, k] != 0.0:
            highest = min(highest, scale[i] * (velocity[k] / q_s[i, k]) ** 2)
        alpha, beta = q_s[i, k] * step, q_ss[i, k] - q_s[i, k] * step
        if beta != 0.0 and abs(alpha) <= VANISHING * abs(beta):
            highest = min(highest, scale[i] * acceleration[k] / abs(beta))
        alpha, beta = q_ss[j, k] + q_s[j, k] * step, -q_s[j, k] * step
        if beta != 0.0 and abs(alpha) <= VANISHING * abs(beta):
            highest = min(highest, scale[j] * acceleration[k] / abs(beta))
    for first in (0, 3):
        speed, limit = tool[first // 3 * 2], tool[first // 3 * 2 + 1]
        square = 0.0
        for k in range(first, first + 3):
            square += x_s[i, k] ** 2
        if square > 0.0:
            highest = min(highest, scale[i] * speed**2 / square)
        for end in range(2):
            _, _, across = _cone(x_s, x_ss, i, end, step, first)
            if across > 0.0:
                highest = min(highest, TIP * scale[i + end] * limit / sqrt(across))
    return highest


@compiled(nrt=False)
def _following_speeds(
    grid: Grid, limits: MotionLimits, scale: Array, i: int, u: float, bounds: Array
) -> None:
    """Fill lowest and highest s_dot^2 at point i + 1 after u at point i, and their slopes over u, (4,)."""
    s, q_s, q_ss, x_s, x_ss = grid
    _, acceleration, tool = limits
    j, step = i + 1, 0.5 / (s[i + 1] - s[i])
    bounds[0], bounds[1], bounds[2], bounds[3] = -inf, inf, 0.0, 0.0
    for k in range(acceleration.size):
        # q'' u + q' (v - u) / (2 h) at point i, q'' v + q' (v - u) / (2 h) at point i + 1
        beside, beyond = q_s[i, k] * step, q_s[j, k] * step
        _narrow(beside, q_ss[i, k] - beside, scale[i] * acceleration[k], u, bounds)
        _narrow(q_ss[j, k] + beyond, -beyond, scale[j] * acceleration[k], u, bounds)
    for first in (0, 3):
        limit = tool[first // 3 * 2 + 1]
        if limit == inf:
            continue
        for end in range(2):
            square, along, across = _cone(x_s, x_ss, i, end, step, first)
            if square <= VANISHING * (across + along * along / max(square, 1e-300)):
                continue
            room = max((scale[i + end] * limit) ** 2 - across * u * u, 0.0)
            half, center = sqrt(room / square), -along / square
            steep = across * u / sqrt(room * square) if room > 0.0 else inf
            if center * u + half < bounds[1]:
                bounds[1], bounds[3] = center * u + half, center - steep
            if center * u - half > bounds[0]:
                bounds[0], bounds[2] = center * u - half, center + steep


@compiled(nrt=False)
def _narrow(alpha: float, beta: float, limit: float, u: float, bounds: Array) -> None:
    """Narrow the speeds v to |alpha v + beta u| <= limit."""
    if abs(alpha) <= VANISHING * abs(beta) or alpha == 0.0:
        return
    slope, half = -beta / alpha, limit / abs(alpha)
    if slope * u + half < bounds[1]:
        bounds[1], bounds[3] = slope * u + half, slope
    if slope * u - half > bounds[0]:
        bounds[0], bounds[2] = slope * u - half, slope


@compiled(nrt=False)
def _cone(x_s: Array, x_ss: Array, i: int, end: int, step: float, first: int) -> tuple[float, float, float]:
    """For the tool's acceleration d v + p u: d . d, d . p, and the square of the part of p normal to d."""
    dd, dp, pp = 0.0, 0.0, 0.0
    for k in range(first, first + 3):
        slope = x_s[i + end, k] * step
        if end == 0:
            d, p = slope, x_ss[i, k] - slope
        else:
            d, p = x_ss[i + 1, k] + slope, -slope
        dd, dp, pp = dd + d * d, dp + d * p, pp + p * p
    if dd <= VANISHING * pp:
        return 0.0, 0.0, pp
    across = pp - dp * dp / dd
    # A difference of nearly equal numbers; a result of the size of rounding counts as 0.
    return dd, dp, across if across > VANISHING * pp else 0.0
