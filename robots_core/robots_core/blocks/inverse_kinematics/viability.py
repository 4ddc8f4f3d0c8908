# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Viability of one axis in discrete time: speeds from which it can stop before its limit.

An axis whose acceleration is constant over each period dt moves by dt (v + w) / 2 while its speed goes from
v to w. Braking by the same deceleration a in every period, and by less in the last one so that it ends at
rest, takes the distance

    D(v) = dt (v / 2 + k v - a dt k (k + 1) / 2),    k = floor(v / (a dt)),

exact and not only the limit dt -> 0, v^2 / (2 a). A state is viable when this distance ends before the limit.
From a viable state braking leads to a viable state, so that there is always a next step; between the samples
the axis does not pass the limit either, because where its speed changes sign within a period it moves on by
less than dt v / 2 <= D(v).
"""

from math import floor, inf, sqrt

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array


@compiled()
def braking_distance(speed: float, deceleration: float, dt: float) -> float:
    """D(v) of a speed v >= 0, rad (m)."""
    k = floor(speed / (deceleration * dt))
    return dt * (0.5 * speed + k * speed - 0.5 * deceleration * dt * k * (k + 1.0))


@compiled()
def fastest_stoppable(distance: float, deceleration: float, dt: float) -> float:
    """Highest speed w at the end of a period from which an axis can stop.

    Args:
        distance: From the position in which the period would end at rest to the limit, rad (m): w solves
            the piecewise linear equation dt w / 2 + D(w) = distance.
        deceleration: Of the braking, rad/s^2.
        dt: s.

    Returns:
        rad/s; negative for a negative distance: the axis has to move back.
    """
    if distance == inf:
        return inf
    if distance < 0.0:
        return 2.0 * distance / dt
    k = floor(0.5 * (sqrt(1.0 + 8.0 * distance / (deceleration * dt * dt)) - 1.0))
    return (distance / dt + 0.5 * deceleration * dt * k * (k + 1.0)) / (k + 1.0)


@compiled()
def velocity_interval(q: Array, q_dot: Array, limits: Array, dt: float, low: Array, high: Array) -> None:
    """Fill the velocities [low, high], (n,) each, that the axes may have after the next period.

    The rows of `limits` are lower, upper, velocity, acceleration, and a deceleration that is at most the
    acceleration. The velocities keep the limits, and lead to states viable for braking by the deceleration.
    From a state outside, the acceleration limit is kept and the others are approached as fast as it allows.
    """
    for i in range(q.size):
        v, velocity, deceleration = q_dot[i], limits[2, i], limits[4, i]
        change = limits[3, i] * dt
        ahead = 0.5 * dt * v
        above, below = limits[1, i] - q[i], q[i] - limits[0, i]
        top = min(velocity, fastest_stoppable(above - ahead, deceleration, dt))
        bottom = -min(velocity, fastest_stoppable(below + ahead, deceleration, dt))
        # Braking is always admissible; rounding must not exclude it on the boundary.
        brake = v - min(max(v, -deceleration * dt), deceleration * dt)
        if v > 0.0 and above >= ahead:
            top = max(top, min(brake, velocity))
        if v < 0.0 and below >= -ahead:
            bottom = min(bottom, max(brake, -velocity))
        top = min(max(top, v - change), v + change)
        bottom = min(max(bottom, v - change), v + change)
        if bottom > top:
            bottom = top = 0.5 * (bottom + top)
        low[i], high[i] = bottom, top
