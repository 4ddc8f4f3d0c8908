# ruff: noqa: PLR0917  # compiled functions take arrays
"""SwitchedTimeLaw: s(t) from a speed profile whose acceleration may jump, with short ramps at the jumps."""

from __future__ import annotations

from math import inf, sqrt

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

SMALLEST_JUMP = 2e-3  # of a limit; smaller jumps of acceleration get no points of their own
CLOSEST = 0.3  # of a ramp; grid points closer than this to another point are left out
CLOSEST_RAMPS = 2e-4  # s between the ends of two ramps
BISECTIONS = 40  # resolve a nanosecond in a quarter of an hour


class SwitchedTimeLaw:
    """s(t), cubic from grid point to grid point, averaged over a moving window.

    The average makes s_ddot continuous (a jump becomes a ramp as long as the window), preserves rest at both
    ends, and lengthens the motion by the window. Before a start that is not at rest s_ddot is constant.

    Args:
        s: Path grid, (m,), to 1.
        speed_squared: s_dot^2 at the grid points, (m,); 0 at the end, above 0 between start and end.
        difference: Change of s_ddot within every interval, (m - 1,).
        window: Length of the window, s, above 0.
        before: s_ddot before the start; 0 where it is at rest.
    """

    def __init__(
        self, s: Array, speed_squared: Array, difference: Array, window: float, *, before: float = 0.0
    ) -> None:
        self._t, self._pieces = np.empty(len(s)), np.empty((len(s), 5))
        law_pieces(s, speed_squared, difference, self._t, self._pieces)
        self._before = before
        self.window = window
        """s."""

    @property
    def duration(self) -> float:
        """Duration, s, with the window."""
        return float(self._t[-1]) + self.window

    @property
    def grid_times(self) -> Array:
        """Approximate times at which s passes the grid points, (m,) s."""
        times: Array = self._t + 0.5 * self.window
        return times

    @property
    def at_grid(self) -> tuple[Array, Array, Array]:
        """Before averaging: s_dot at grid points, (m,); s_ddot at starts and ends of intervals, (m - 1,)."""
        speed, begin = self._pieces[:, 2], self._pieces[:-1, 3]
        return speed, begin, begin + np.diff(self._t) * self._pieces[:-1, 4]

    def s_of(self, t: Array) -> tuple[Array, Array, Array]:
        """s, s_dot and s_ddot at increasing times `t` (m,), each (m,)."""
        values = np.empty((3, len(t)))
        averaged(self._t, self._pieces, self._before, self.window, t, values)
        return values[0], values[1], values[2]

    def times_of(self, s: Array) -> Array:
        """Times, (m,) s, at which s has the values `s` (m,), each between 0 and 1."""
        low, high = np.zeros(len(s)), np.full(len(s), self.duration)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            passed = self.s_of(middle)[0] > s
            low, high = np.where(passed, low, middle), np.where(passed, middle, high)
        return high

    def sample_times(self, longest: float, weight: Array) -> Array:
        """Times (m,) of a trajectory's points: both ends of every ramp, and no interval above `longest`.

        Args:
            longest: Longest interval, s.
            weight: Use of a limit per unit of s_ddot at the grid points, (m,): jumps with a small use get no
                points of their own.
        """
        times = np.empty(int(self.duration / longest) + 4 * len(self._t) + 8)
        count = fill_times(self._t, self._pieces, self._before, self.window, longest, weight, times)
        return times[:count]


@compiled(counted=False)
def law_pieces(s: Array, u: Array, difference: Array, t: Array, pieces: Array) -> None:
    """Fill start times t (m,) and pieces (m, 5): integral of s so far, s, s_dot, s_ddot and s_dddot."""
    m = s.size
    t[0] = 0.0
    area = 0.0
    for i in range(m - 1):
        begin, end = sqrt(u[i]), sqrt(u[i + 1])
        total, step = begin + end, s[i + 1] - s[i]
        # The cubic that matches both points and speeds, and whose s_ddot changes by the difference.
        root = total * total - 4.0 / 3.0 * step * difference[i]
        h = 4.0 * step / (total + sqrt(root)) if root > 0.0 else 2.0 * step / total
        first = (6.0 * step / h - 4.0 * begin - 2.0 * end) / h
        last = (2.0 * begin + 4.0 * end - 6.0 * step / h) / h
        jerk = (last - first) / h
        pieces[i, 0], pieces[i, 1], pieces[i, 2], pieces[i, 3], pieces[i, 4] = area, s[i], begin, first, jerk
        area += h * (s[i] + h * (begin / 2.0 + h * (first / 6.0 + h * jerk / 24.0)))
        t[i + 1] = t[i] + h
    last_piece = pieces[m - 1]
    last_piece[:] = 0.0
    last_piece[0], last_piece[1] = area, s[m - 1]


@compiled(counted=False)
def _state(t: Array, pieces: Array, early: float, time: float, i: int) -> tuple[float, float, float, int]:
    """Integral of s, s and s_dot at a time, searched from piece i on; and the index of the piece."""
    if time <= 0.0:
        s, v = pieces[0, 1], pieces[0, 2]
        return (
            time * (s + time * (v / 2.0 + time * early / 6.0)),
            s + time * (v + time * early / 2.0),
            v + time * early,
            i,
        )
    while i < t.size - 1 and t[i + 1] <= time:
        i += 1
    x = time - t[i]
    area, s, v, a, j = pieces[i, 0], pieces[i, 1], pieces[i, 2], pieces[i, 3], pieces[i, 4]
    return (
        area + x * (s + x * (v / 2.0 + x * (a / 6.0 + x * j / 24.0))),
        s + x * (v + x * (a / 2.0 + x * j / 6.0)),
        v + x * (a + x * j / 2.0),
        i,
    )


@compiled(counted=False)
def averaged(t: Array, pieces: Array, early: float, window: float, times: Array, values: Array) -> None:
    """Fill values (3, m): s, s_dot, s_ddot of the averaged law at increasing times.

    Before the start s_ddot is `early`.
    """
    front = back = 0
    for k in range(times.size):
        area, s, v, front = _state(t, pieces, early, times[k], front)
        past_area, past_s, past_v, back = _state(t, pieces, early, times[k] - window, back)
        values[0, k] = (area - past_area) / window
        values[1, k] = (s - past_s) / window
        values[2, k] = (v - past_v) / window


@compiled(counted=False)
def _fill_jumps(t: Array, pieces: Array, early: float, weight: Array, jumps: Array) -> int:
    """Fill the grid times at which acceleration jumps, and return their number."""
    number = 0
    for i in range(t.size):
        before = early if i == 0 else pieces[i - 1, 3] + (t[i] - t[i - 1]) * pieces[i - 1, 4]
        after = 0.0 if i == t.size - 1 else pieces[i, 3]
        if weight[i] * abs(after - before) > SMALLEST_JUMP:
            jumps[number] = t[i]
            number += 1
    return number


@compiled()
def fill_times(
    t: Array, pieces: Array, early: float, window: float, longest: float, weight: Array, times: Array
) -> int:
    """Fill times and return their number: ends of ramps, and between them steps of at most `longest`."""
    m, jumps = t.size, np.full(t.size + 1, inf)
    number = _fill_jumps(t, pieces, early, weight, jumps)
    # Points that nearly coincide add nothing and magnify rounding.
    apart = CLOSEST * min(window, longest)
    closest = min(apart, CLOSEST_RAMPS)
    times[0], count = 0.0, 1
    # The next ramp to begin, the next to end, the next grid point, and the next jump among those.
    begin = end = i = jump = 0
    while end < number or i < m:
        ramp = min(jumps[begin], jumps[end] + window)
        time, least = ramp, closest
        if i < m and t[i] == jumps[jump]:
            i, jump = i + 1, jump + 1
            continue
        if i < m and t[i] + 0.5 * window < ramp:
            time, least = t[i] + 0.5 * window, apart
            i += 1
            if ramp - time < apart:
                continue
        elif jumps[begin] == ramp:
            begin += 1
        else:
            end += 1
        gap = time - times[count - 1]
        if gap < least:
            continue
        parts = int(np.ceil(gap / longest))
        start = times[count - 1]
        for part in range(1, parts + 1):
            times[count] = start + gap * part / parts
            count += 1
    duration = t[m - 1] + window
    if duration - times[count - 1] < closest and count > 1:
        count -= 1
    times[count] = duration
    return count + 1
