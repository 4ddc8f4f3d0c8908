# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""The time-optimal jerk-limited motion of one coordinate from rest to rest, in closed form.

The jerk is a train of rectangles of one height: s(t) is a step of the whole way, averaged over three windows
x <= y, x + y <= z one after the other. Peaks are way / z for the velocity, way / (z y) for the acceleration
and way / (z y x) for the jerk, and the motion lasts x + y + z (Biagiotti and Melchiorri 2008, sections 3.4
and 4.5). Each window may be longer than needed, and no limit is broken: that is how switches of jerk come to
lie on whole ticks.
"""

from __future__ import annotations

from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.robot_model.analytic.compiled import compiled, sort_in_place
from robots_core.validation import Array

NANOSECOND = 1e-9  # s
# A window that is a whole number of ticks but for rounding is one.
ROUNDING = 1e-6

Instants = NDArray[np.int64]
"""Nanoseconds from the start."""


@compiled()
def windows(way: float, velocity: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """The shortest windows x, y, z, s, that keep the limits over a way > 0."""
    z, x = way / velocity, acceleration / jerk
    y = velocity / acceleration
    if y < x:
        x = y = sqrt(velocity / jerk)
    if z >= x + y:
        return x, y, z
    # The highest speed is not reached.
    x = acceleration / jerk
    y = 0.5 * (sqrt(x * x + 4.0 * way / acceleration) - x)
    if y < x:
        x = y = (0.5 * way / jerk) ** (1.0 / 3.0)
    return x, y, x + y


@compiled()
def whole_windows(
    way: float, velocity: float, acceleration: float, jerk: float, tick: int, shortest: int
) -> tuple[int, int, int]:
    """Windows x, y, z in whole ticks, in nanoseconds, between whose switches there is `shortest` or nothing.

    Args:
        way: > 0, rad (m).
        velocity: Limit, rad/s.
        acceleration: Limit, rad/s^2.
        jerk: Limit, rad/s^3.
        tick: ns.
        shortest: Length of the shortest piece of constant jerk, ns; a multiple of `tick`.
    """
    z = windows(way, velocity, acceleration, jerk)[2]
    unit = tick * NANOSECOND
    fewest = shortest // tick
    best, found = inf, (0, 0, 0)
    # A window that is rounded up lets the shorter ones be shorter, so that few choices have to be looked at.
    for more_z in range(2):
        for more_y in range(2):
            k_z = max(ceil(z / unit - ROUNDING) + more_z, 2 * fewest)
            # By the limits of acceleration and, as x <= y, of jerk.
            y = max(way / (acceleration * k_z * unit), sqrt(way / (jerk * k_z * unit)))
            k_y = max(ceil(y / unit - ROUNDING) + more_y, fewest)
            k_x = max(ceil(way / (jerk * k_z * k_y * unit**3) - ROUNDING), fewest)
            k_x, k_y, k_z = spaced(k_x, k_y, k_z, fewest)
            if k_x + k_y + k_z < best:
                best, found = k_x + k_y + k_z, (k_x * tick, k_y * tick, k_z * tick)
    return found


@compiled()
def spaced(x: int, y: int, z: int, fewest: int) -> tuple[int, int, int]:
    """Windows that are no shorter, ordered, and differ by nothing or by at least `fewest` ticks."""
    y = max(y, x)
    if 0 < y - x < fewest:
        if y - x <= x + fewest - y:
            x = y
        else:
            y = x + fewest
    z = max(z, x + y)
    gap = z - x - y
    if 0 < gap < fewest:
        if gap <= fewest - gap and y + gap - x >= fewest:
            y += gap
        else:
            z = x + y + fewest
    return x, y, z


@compiled()
def fill_switches(x: int, y: int, z: int, times: Instants) -> None:
    """Fill the eight instants, ns, at which jerk changes."""
    times[0], times[1], times[2], times[3] = 0, x, y, x + y
    end = x + y + z
    times[4], times[5], times[6], times[7] = end - x - y, end - y, end - x, end


@compiled()
def state(way: float, x: int, y: int, z: int, t: int) -> tuple[float, float, float]:
    """Position, velocity and acceleration at an instant, ns, after the start; at rest after the end."""
    end = x + y + z
    if t <= 0:
        return 0.0, 0.0, 0.0
    if t >= end:
        return way, 0.0, 0.0
    if 2 * t > end:
        s, v, a = _accelerating(way, x, y, z, end - t)
        return way - s, v, -a
    return _accelerating(way, x, y, z, t)


@compiled()
def _accelerating(way: float, x: int, y: int, z: int, t: int) -> tuple[float, float, float]:
    """The first half."""
    speed = way / (z * NANOSECOND)
    highest = speed / (y * NANOSECOND)
    jerk = highest / (x * NANOSECOND)
    if t <= x:
        tau = t * NANOSECOND
        return jerk * tau**3 / 6.0, 0.5 * jerk * tau * tau, jerk * tau
    if t <= y:
        ramp, tau = x * NANOSECOND, (t - x) * NANOSECOND
        v = 0.5 * highest * ramp
        return jerk * ramp**3 / 6.0 + tau * (v + 0.5 * highest * tau), v + highest * tau, highest
    reached = 0.5 * speed * (x + y) * NANOSECOND
    if t < x + y:
        tau = (x + y - t) * NANOSECOND
        return reached - speed * tau + jerk * tau**3 / 6.0, speed - 0.5 * jerk * tau * tau, jerk * tau
    return reached + speed * (t - x - y) * NANOSECOND, speed, 0.0


@compiled()
def line(
    start: Array, target: Array, limits: Array, tick: int, shortest: int
) -> tuple[Array, Array, Array, Array]:
    """All coordinates together on the straight line between two points that differ.

    Args:
        start: (n,), rad (m).
        target: (n,).
        limits: (3, n): velocity, acceleration and jerk.
        tick: ns.
        shortest: Of a piece of constant jerk, ns.

    Returns:
        Times (m,), s, of the switches of jerk; positions, velocities and accelerations there, (m, n) each.
    """
    n = start.size
    # The path coordinate in units of the longest way, so that short moves keep their digits.
    longest = 0.0
    for i in range(n):
        longest = max(longest, abs(target[i] - start[i]))
    velocity = acceleration = jerk = inf
    for i in range(n):
        share = abs(target[i] - start[i]) / longest
        if share > 0.0:
            velocity = min(velocity, limits[0, i] / share)
            acceleration = min(acceleration, limits[1, i] / share)
            jerk = min(jerk, limits[2, i] / share)
    x, y, z = whole_windows(longest, velocity, acceleration, jerk, tick, shortest)
    instants = np.empty(8, dtype=np.int64)
    fill_switches(x, y, z, instants)
    instants = distinct(instants)
    m = instants.size
    time, q, q_dot, q_ddot = np.empty(m), np.empty((m, n)), np.empty((m, n)), np.empty((m, n))
    for row in range(m):
        time[row] = instants[row] / 1e9
        s, s_dot, s_ddot = state(longest, x, y, z, instants[row])
        for i in range(n):
            direction = (target[i] - start[i]) / longest
            q[row, i] = start[i] + s * direction
            q_dot[row, i] = s_dot * direction
            q_ddot[row, i] = s_ddot * direction
    q[m - 1] = target
    return time, q, q_dot, q_ddot


@compiled()
def each_axis(
    start: Array, target: Array, limits: Array, tick: int, shortest: int
) -> tuple[Array, Array, Array, Array]:
    """Every coordinate on its own, as `line`; an empty time if switches come closer than `shortest`."""
    n = start.size
    chosen = np.zeros((n, 3), dtype=np.int64)
    instants = np.zeros((n, 8), dtype=np.int64)
    for i in range(n):
        way = abs(target[i] - start[i])
        if way > 0.0:
            x, y, z = whole_windows(way, limits[0, i], limits[1, i], limits[2, i], tick, shortest)
            chosen[i, 0], chosen[i, 1], chosen[i, 2] = x, y, z
            fill_switches(x, y, z, instants[i])
    together = distinct(instants.ravel())
    m = together.size
    for row in range(m - 1):
        if together[row + 1] - together[row] < shortest:
            m = 0
    time, q, q_dot, q_ddot = np.empty(m), np.empty((m, n)), np.empty((m, n)), np.empty((m, n))
    for row in range(m):
        time[row] = together[row] / 1e9
        for i in range(n):
            if target[i] == start[i]:
                q[row, i], q_dot[row, i], q_ddot[row, i] = target[i], 0.0, 0.0
                continue
            x, y, z = chosen[i, 0], chosen[i, 1], chosen[i, 2]
            sign = 1.0 if target[i] > start[i] else -1.0
            s, s_dot, s_ddot = state(abs(target[i] - start[i]), x, y, z, together[row])
            q[row, i] = start[i] + sign * s if together[row] < x + y + z else target[i]
            q_dot[row, i], q_ddot[row, i] = sign * s_dot, sign * s_ddot
    return time, q, q_dot, q_ddot


@compiled()
def inside(q: Array, lower: Array, upper: Array) -> bool:
    """No value (n,) is outside its limits; NaN is."""
    for i in range(q.size):  # noqa: SIM110  # compiled
        if not lower[i] <= q[i] <= upper[i]:
            return False
    return True


@compiled()
def distinct(instants: Instants) -> Instants:
    """Sorted, each once."""
    ordered = instants.copy()
    sort_in_place(ordered)
    count = 1
    for value in ordered[1:]:
        if value > ordered[count - 1]:
            ordered[count] = value
            count += 1
    return ordered[:count].copy()
