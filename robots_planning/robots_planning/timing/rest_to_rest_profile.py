# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""The time-optimal jerk-limited motion of one coordinate from rest to rest, in closed form.

The jerk is piecewise constant with values 0 and +-j: s(t) is a step of the distance d, filtered by three
moving averages with windows x <= y, x + y <= z. The peaks are d / z for the velocity, d / (z y) for the
acceleration and d / (z y x) for the jerk, and the motion lasts x + y + z (Biagiotti and Melchiorri 2008,
sections 3.4 and 4.5). Longer windows keep the limits too, so windows are rounded up until switches of jerk
lie on whole ticks.
"""

from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.kernels.compiled import compiled, sort_in_place
from robots_core.validation import Array

NANOSECOND = 1e-9  # s
# In ticks: a window that exceeds a whole number of ticks by less than this is rounded down.
ROUNDING = 1e-6

Instants = NDArray[np.int64]
"""Nanoseconds from the start."""


@compiled()
def windows(distance: float, velocity: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """The shortest windows x, y, z, s, that keep the limits over a distance > 0."""
    z, x = distance / velocity, acceleration / jerk
    y = velocity / acceleration
    if y < x:
        x = y = sqrt(velocity / jerk)
    if z >= x + y:
        return x, y, z
    # The highest speed is not reached.
    x = acceleration / jerk
    y = 0.5 * (sqrt(x * x + 4.0 * distance / acceleration) - x)
    if y < x:
        x = y = (0.5 * distance / jerk) ** (1.0 / 3.0)
    return x, y, x + y


@compiled()
def whole_windows(
    distance: float, velocity: float, acceleration: float, jerk: float, tick: int, shortest: int
) -> tuple[int, int, int]:
    """Windows x, y, z, ns, in whole ticks; switches of jerk coincide or are at least `shortest` apart.

    Args:
        distance: > 0, rad (m).
        velocity: Limit, rad/s.
        acceleration: Limit, rad/s^2.
        jerk: Limit, rad/s^3.
        tick: ns.
        shortest: Length of the shortest piece of constant jerk, ns; a multiple of `tick`.
    """
    z = windows(distance, velocity, acceleration, jerk)[2]
    unit = tick * NANOSECOND
    fewest = shortest // tick
    best, found = inf, (0, 0, 0)
    # A longer window allows shorter other ones; checking one tick more for z and y is enough.
    for more_z in range(2):
        for more_y in range(2):
            k_z = max(ceil(z / unit - ROUNDING) + more_z, 2 * fewest)
            # By the limits of acceleration and, as x <= y, of jerk.
            y = max(distance / (acceleration * k_z * unit), sqrt(distance / (jerk * k_z * unit)))
            k_y = max(ceil(y / unit - ROUNDING) + more_y, fewest)
            k_x = max(ceil(distance / (jerk * k_z * k_y * unit**3) - ROUNDING), fewest)
            k_x, k_y, k_z = spaced(k_x, k_y, k_z, fewest)
            if k_x + k_y + k_z < best:
                best, found = k_x + k_y + k_z, (k_x * tick, k_y * tick, k_z * tick)
    return found


@compiled()
def spaced(x: int, y: int, z: int, fewest: int) -> tuple[int, int, int]:
    """Windows lengthened so that they are ordered and each gap is 0 or at least `fewest` ticks."""
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
def state(distance: float, x: int, y: int, z: int, t: int) -> tuple[float, float, float]:
    """Position, velocity and acceleration at an instant, ns, after the start; at rest after the end."""
    end = x + y + z
    if t <= 0:
        return 0.0, 0.0, 0.0
    if t >= end:
        return distance, 0.0, 0.0
    if 2 * t > end:
        s, v, a = _accelerating(distance, x, y, z, end - t)
        return distance - s, v, -a
    return _accelerating(distance, x, y, z, t)


@compiled()
def _accelerating(distance: float, x: int, y: int, z: int, t: int) -> tuple[float, float, float]:
    """`state` in the first half of the motion."""
    speed = distance / (z * NANOSECOND)
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
    """Synchronous motion of all coordinates on the straight line between two different points.

    Args:
        start: (n,), rad (m).
        target: (n,).
        limits: (3, n): velocity, acceleration and jerk.
        tick: ns.
        shortest: Of a piece of constant jerk, ns.

    Returns:
        Times (m,), s, of the switches of jerk; positions, velocities and accelerations there, (m, n) each.
    """
    # The path coordinate is the longest displacement, so that short moves keep their precision.
    way = target - start
    longest = np.abs(way).max()
    narrowest = np.full((3, 1), inf)
    for i in range(start.size):
        share = abs(way[i]) / longest
        for order in range(3):
            if share > 0.0:
                narrowest[order, 0] = min(narrowest[order, 0], limits[order, i] / share)
    time, s, s_dot, s_ddot = _profiles(np.array([longest]), narrowest, tick, shortest)
    direction = way / longest
    q = start + s * direction
    q[-1] = target
    return time, q, s_dot * direction, s_ddot * direction


@compiled()
def each_axis(
    start: Array, target: Array, limits: Array, tick: int, shortest: int
) -> tuple[Array, Array, Array, Array]:
    """Independent motion of every coordinate, as `line`; empty if switches are closer than `shortest`."""
    way = target - start
    time, s, s_dot, s_ddot = _profiles(np.abs(way), limits, tick, shortest)
    for row in range(time.size - 1):
        if time[row + 1] - time[row] < (shortest - 0.5) * NANOSECOND:
            return np.empty(0), s[:0], s_dot[:0], s_ddot[:0]
    sign = np.sign(way)
    q = start + s * sign
    for i in range(start.size):
        for row in range(time.size):
            if s[row, i] == abs(way[i]):
                q[row, i] = target[i]
    return time, q, s_dot * sign, s_ddot * sign


@compiled()
def _profiles(distances: Array, limits: Array, tick: int, shortest: int) -> tuple[Array, Array, Array, Array]:
    """Independent motions over distances (n,) >= 0: times of all switches of jerk, and `state` there."""
    n = distances.size
    chosen, instants = np.zeros((n, 3), dtype=np.int64), np.zeros((n, 8), dtype=np.int64)
    for i in range(n):
        if distances[i] > 0.0:
            x, y, z = whole_windows(distances[i], limits[0, i], limits[1, i], limits[2, i], tick, shortest)
            end = x + y + z
            chosen[i] = x, y, z
            instants[i] = 0, x, y, x + y, end - x - y, end - y, end - x, end
    together = distinct(instants.ravel())
    m = together.size
    s, s_dot, s_ddot = np.empty((m, n)), np.empty((m, n)), np.empty((m, n))
    for row in range(m):
        for i in range(n):
            x, y, z = chosen[i]
            s[row, i], s_dot[row, i], s_ddot[row, i] = state(distances[i], x, y, z, together[row])
    return together / 1e9, s, s_dot, s_ddot


@compiled()
def inside(q: Array, lower: Array, upper: Array) -> bool:
    """Whether all values (n,) are inside their limits; NaN is not."""
    for i in range(q.size):  # noqa: SIM110  # compiled
        if not lower[i] <= q[i] <= upper[i]:
            return False
    return True


@compiled()
def distinct(instants: Instants) -> Instants:
    """The instants, sorted and without duplicates."""
    ordered = instants.copy()
    sort_in_place(ordered)
    count = 1
    for value in ordered[1:]:
        if value > ordered[count - 1]:
            ordered[count] = value
            count += 1
    return ordered[:count].copy()
