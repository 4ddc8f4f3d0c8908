# ruff: noqa: PLR0917  # compiled loops over arrays
"""From a joint path to the points of a trajectory by the two-pass algorithm, compiled."""

from math import ceil, inf, sqrt

import numpy as np

from robots_core.kernels.compiled import compiled, sort_in_place
from robots_core.validation import Array
from robots_planning.paths.cartesian_path_kernel import PathArrays, poses_on_path
from robots_planning.timing.quintic import (
    interval_at,
    quintic_coefficients,
    quintic_uses,
    quintics_at,
)
from robots_planning.timing.speed_profile import fastest_speeds
from robots_planning.timing.switched_time_law import averaged, law_pieces
from robots_planning.timing.tool_limits import STANDSTILL, travel

GRID = 240  # points of the speed profile over the path, at least
GRID_ROUNDING = 1e-9  # of a grid interval: rounding of the samples must not add an interval
POINTS_PER_SAMPLE = 4  # so that the trajectory's quintics follow those of the joint path
# Points closer than this are merged: the quintic divides rounding by the fifth power of the interval.
CLOSEST_POINTS = 2e-4  # s
# Of the smoothing window; other points closer than this to the end of a jump are left out.
POINT_DISTANCE = 0.2
# Jumps of acceleration larger than this fraction of a limit get points at both ends of their smoothing.
NOTABLE_JUMP = 0.03
ROUNDS = 16  # of lowering limits that smoothing broke
# Exponent on the slow-down: slightly more than needed, so that few rounds suffice.
SLOWER = 1.1
# Largest slow-down per round: with a large excess, less turns out to be enough.
LARGEST_FACTOR = 1.5
GOOD_ENOUGH = 1.002  # use of a limit at which a uniform slow-down is cheaper than another round
# Smoothing and interpolation shift speeds to places with slightly different limits.
SMOOTHING_MARGIN = 1e-3
STRETCH_EXCESS = 1e-7  # so that rounding does not cause another round
STRETCHES = 4
Points = tuple[Array, Array, Array, Array]
"""Times (k,), positions, velocities and accelerations (k, n)."""

Grid = tuple[Array, Array, Array, tuple[Array, Array, Array]]
"""s (m,), increasing; q' and q'' of the axes, (m, n); `travel` of the tool, (m, 2) each."""

TimeLaw = tuple[Array, Array]
"""Times, (m,), and pieces, (m, 5), of `law_pieces`."""

PathLimits = tuple[Array, Array]
"""Velocity, acceleration and jerk of the axes, (3, n); speed, acceleration, angular speed and angular
acceleration of the tool, (4,), each on the norm of a vector. Infinite where there is none."""


@compiled()
def speed_grid(path_s: Array) -> Array:
    """Path grid that contains all of path_s (k,), subdivided evenly into at least about `GRID` intervals."""
    total = 0
    for i in range(path_s.size - 1):
        total += _parts(path_s[i + 1] - path_s[i])
    s, row = np.empty(total + 1), 0
    for i in range(path_s.size - 1):
        parts = _parts(path_s[i + 1] - path_s[i])
        for part in range(parts):
            s[row] = path_s[i] + (path_s[i + 1] - path_s[i]) * part / parts
            row += 1
    s[row] = path_s[-1]
    return s


@compiled()
def _parts(interval: float) -> int:
    """Number of parts into which an interval of the path is divided."""
    return max(ceil(interval * GRID - GRID_ROUNDING), POINTS_PER_SAMPLE)


@compiled()
def grid_of(path_s: Array, coefficients: Array, tool_path: PathArrays) -> Grid:
    """Derivatives of axes and tool on the speed grid of a joint path."""
    s = speed_grid(path_s)
    m, n = s.size, coefficients.shape[2]
    q, q_s, q_ss = np.empty((m, n)), np.empty((m, n)), np.empty((m, n))
    quintics_at(path_s, coefficients, s, q, q_s, q_ss)
    x_s, x_ss = np.empty((m, 6)), np.empty((m, 6))
    poses_on_path(tool_path, s, np.empty((m, 3)), np.empty((m, 3, 3)), x_s, x_ss)
    return s, q_s, q_ss, travel(x_s, x_ss)


@compiled()
def speed_limits(grid: Grid, axes: Array, tool: Array) -> tuple[Array, Array]:
    """Limits of axes and tool as in `fastest_speeds`: rows (m, n + 2, 4), and the highest s_dot^2, (m,)."""
    _, q_s, q_ss, (rate, along, across) = grid
    m, n = q_s.shape
    rows, highest = np.zeros((m, n + 2, 4)), np.full(m, inf)
    for i in range(m):
        for k in range(n):
            rows[i, k, 0], rows[i, k, 1] = q_s[i, k] / axes[1, k], q_ss[i, k] / axes[1, k]
            if q_s[i, k] != 0.0:
                highest[i] = min(highest[i], (axes[0, k] / q_s[i, k]) ** 2)
        for part in range(2):
            row, speed, limit = rows[i, n + part], tool[2 * part], tool[2 * part + 1]
            if rate[i, part] > STANDSTILL:
                row[0], row[1] = rate[i, part] / limit, along[i, part] / limit
                highest[i] = min(highest[i], (speed / rate[i, part]) ** 2)
            if across[i, part] > STANDSTILL:
                row[3] = across[i, part] / limit
    return rows, highest


@compiled()
def two_pass(s: Array, rows: Array, highest: Array, scale: Array) -> TimeLaw:
    """The fastest motion from rest to rest with s_ddot constant from point to point.

    Args:
        s: Path grid, (m,), from 0 to 1.
        rows: See `speed_limits`.
        highest: See `speed_limits`.
        scale: Part of the limits to use at each point, (m,): of accelerations, and of squared speeds.
    """
    m = s.size
    speeds, change = np.zeros(m), np.empty(m - 1)
    fastest_speeds(s, rows, highest * scale, scale, 1, speeds, change)
    law = (np.empty(m), np.empty((m, 5)))
    law_pieces(s, speeds, change, *law)
    return law


@compiled()
def timed_points(
    path_s: Array, coefficients: Array, grid: Grid, limits: PathLimits, window: float, share: float
) -> Points:
    """Points of the fastest smooth motion along a joint path that keeps all limits, between points too.

    Where smoothing breaks a limit, the motion is slowed down locally, in a few rounds; a remaining excess is
    removed by a uniform slow-down.

    Args:
        path_s: s of the joint path, (k,).
        coefficients: Of its quintics, (k - 1, 6, n).
        grid: From `grid_of`.
        limits: See `PathLimits`.
        window: Longest smoothing of acceleration, s; the motion is longer by the window.
        share: Longest smoothing, as part of the duration.
    """
    rows, highest = speed_limits(grid, limits[0], limits[1])
    scale = np.full(grid[0].size, 1.0 - SMOOTHING_MARGIN)
    law = two_pass(grid[0], rows, highest, scale)
    width = max(min(window, share * law[0][-1]), 2.0 * CLOSEST_POINTS)
    points, use = _sampled(path_s, coefficients, grid, limits, law, width, 1.0)
    for _ in range(ROUNDS):
        if use.max() <= GOOD_ENOUGH:
            break
        _slow_down(law[0], width, points[0], use, scale)
        law = two_pass(grid[0], rows, highest, scale)
        points, use = _sampled(path_s, coefficients, grid, limits, law, width, 1.0)
    stretch = 1.0
    for _ in range(STRETCHES):
        if use.max() <= 1.0:
            break
        # Use of acceleration and squared speed falls with the square of time, that of jerk faster.
        stretch *= sqrt(use.max()) * (1.0 + STRETCH_EXCESS)
        points, use = _sampled(path_s, coefficients, grid, limits, law, width, stretch)
    return points


@compiled()
def jerk_window(grid: Grid, limits: PathLimits) -> float:
    """The smoothing window with which no jump of the unsmoothed law breaks a jerk limit, s."""
    s, q_s, axes = grid[0], grid[1], limits[0]
    s_ddot = two_pass(s, *speed_limits(grid, axes, limits[1]), np.ones(s.size))[1][:-1, 3]
    window = 0.0
    for i in range(s.size):
        jump = abs((s_ddot[i] if i < s.size - 1 else 0.0) - (s_ddot[i - 1] if i > 0 else 0.0))
        for k in range(axes.shape[1]):
            window = max(window, abs(q_s[i, k]) * jump / axes[2, k])
    return window


@compiled()
def _slow_down(t: Array, window: float, times: Array, use: Array, scale: Array) -> None:
    """Lower the limits at grid points whose smoothing window covers a broken limit."""
    first = 0
    for i in range(t.size):
        while first < use.size - 1 and times[first + 1] < t[i] - window:
            first += 1
        worst, k = 1.0, first
        while k < use.size and times[k] <= t[i] + 2.0 * window:
            worst = max(worst, use[k])
            k += 1
        scale[i] /= min(worst, LARGEST_FACTOR) ** SLOWER


@compiled()
def _point_times(law: TimeLaw, grid: Grid, limits: PathLimits, window: float) -> Array:
    """Times of the points: both ends of the smoothing of every notable jump, and the grid in between."""
    t, s_ddot, q_s = law[0], law[1][:-1, 3], grid[1]
    acceleration, jerk = limits[0][1], limits[0][2]
    m = t.size
    ends, count = np.empty(2 * m), 0
    for i in range(m):
        jump = abs((s_ddot[i] if i < m - 1 else 0.0) - (s_ddot[i - 1] if i > 0 else 0.0))
        for k in range(acceleration.size):
            felt = abs(q_s[i, k]) * jump
            if felt > NOTABLE_JUMP * acceleration[k] or felt > NOTABLE_JUMP * jerk[k] * window:
                ends[count], ends[count + 1] = t[i], t[i] + window
                count += 2
                break
    kinks = ends[:count].copy()
    sort_in_place(kinks)
    others = t[1 : m - 1] + 0.5 * window
    duration = t[-1] + window
    gap = max(POINT_DISTANCE * window, CLOSEST_POINTS)
    times, size = np.empty(count + others.size + 2), 1
    times[0] = 0.0
    i, j = 0, 0
    while i < count or j < others.size:
        kink = kinks[i] if i < count else inf
        other = others[j] if j < others.size else inf
        if kink <= other:
            i += 1
            if kink - times[size - 1] < CLOSEST_POINTS or duration - kink < CLOSEST_POINTS:
                continue
            times[size] = kink
        else:
            j += 1
            if other - times[size - 1] < gap or min(kink, duration) - other < gap:
                continue
            times[size] = other
        size += 1
    times[size] = duration
    return times[: size + 1].copy()


@compiled()
def _sampled(
    path_s: Array,
    coefficients: Array,
    grid: Grid,
    limits: PathLimits,
    law: TimeLaw,
    window: float,
    stretch: float,
) -> tuple[Points, Array]:
    """Points of a time law, slowed down uniformly by `stretch`, and the largest use of a limit per interval.

    The use is the ratio to the limit of acceleration or jerk, or the squared ratio of speed.
    """
    axes, tool = limits
    plan = _point_times(law, grid, limits, window)
    k, n = plan.size, axes.shape[1]
    times, path = np.empty(k), np.empty((3, k))
    for row in range(k):
        # Messages hold whole nanoseconds; points planned at such times are not changed by rounding.
        times[row] = np.floor(plan[row] * stretch * 1e9 + 0.5) / 1e9
    averaged(law[0], law[1], 0.0, window, times / stretch, path)
    path[0, 0], path[0, k - 1] = 0.0, 1.0
    for row in (0, k - 1):
        path[1, row], path[2, row] = 0.0, 0.0
    q, q_dot, q_ddot = np.empty((k, n)), np.empty((k, n)), np.empty((k, n))
    quintics_at(path_s, coefficients, path[0], q, q_dot, q_ddot)
    tool_use = np.empty(k)
    for row in range(k):
        rate, change = path[1, row] / stretch, path[2, row] / stretch**2
        for axis in range(n):
            q_ddot[row, axis] = q_ddot[row, axis] * rate * rate + q_dot[row, axis] * change
            q_dot[row, axis] *= rate
        tool_use[row] = _tool_use(grid, tool, path[0, row], rate, change)
    curve = np.empty((k - 1, 6, n))
    quintic_coefficients(times, q, q_dot, q_ddot, curve)
    uses = np.empty((k - 1, 3))
    quintic_uses(times, curve, axes, uses)
    use = np.maximum(tool_use[:-1], tool_use[1:])
    for row in range(k - 1):
        use[row] = max(use[row], uses[row, 0] ** 2, uses[row, 1], uses[row, 2])
    return (times, q, q_dot, q_ddot), use


@compiled()
def _tool_use(grid: Grid, tool: Array, place: float, s_dot: float, s_ddot: float) -> float:
    """Largest use of the tool's limits at s = `place`, the square of that of speed."""
    s, _, _, (rate, along, across) = grid
    i = interval_at(s, place)
    part = (place - s[i]) / (s[i + 1] - s[i])
    worst = 0.0
    for k in range(2):
        first = rate[i, k] + part * (rate[i + 1, k] - rate[i, k])
        tangential = along[i, k] + part * (along[i + 1, k] - along[i, k])
        normal = across[i, k] + part * (across[i + 1, k] - across[i, k])
        tangential = first * s_ddot + tangential * s_dot**2
        length = sqrt(tangential**2 + (normal * s_dot**2) ** 2)
        worst = max(worst, (first * s_dot / tool[2 * k]) ** 2, length / tool[2 * k + 1])
    return worst
