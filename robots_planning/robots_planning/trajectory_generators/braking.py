"""Braking distance of an axis from any state, and checks of a moving start."""

from math import sqrt

import numpy as np

from robots_core.errors import InvalidInputError, PlanningError
from robots_core.robot_model.axes_data import LIMIT_TOLERANCE, AxesData
from robots_core.validation import Array

# Relative rounding of a state on a limit.
STATE_TOLERANCE = 1e-6


def check_start_motion(axes: AxesData, q: Array, q_dot: Array, q_ddot: Array) -> None:
    """Check that some motion from a state keeps the limits.

    Args:
        axes: The limits.
        q: Positions inside the limits, (n,), rad (m).
        q_dot: Velocities, (n,), rad/s.
        q_ddot: Accelerations, (n,), rad/s^2.

    Raises:
        InvalidInputError: a velocity or acceleration above its limit.
        PlanningError: an axis exceeds its velocity limit before its acceleration can end, or its position
            limit however it brakes; names the value that it would reach.
    """
    for name, values, limits, unit in (
        ('q_dot_start', q_dot, axes.velocity, '/s'),
        ('q_ddot_start', q_ddot, axes.acceleration, '/s^2'),
    ):
        over = np.flatnonzero(np.abs(values) > limits * (1.0 + STATE_TOLERANCE))
        if over.size:
            i = int(over[0])
            raise InvalidInputError(
                f'{name} of {axes.names[i]} is {values[i]:.6g} {axes.unit(i)}{unit}, its limit is '
                f'{limits[i]:.6g} {axes.unit(i)}{unit}',
                joint=axes.names[i],
                value=float(values[i]),
                limit=float(limits[i]),
            )
    coming = q_dot + q_ddot * np.abs(q_ddot) / (2.0 * axes.jerk)
    for i, name in enumerate(axes.names):
        unit = axes.unit(i)
        state = f'{name} at {q[i]:.6g} {unit} with {q_dot[i]:.6g} {unit}/s and {q_ddot[i]:.6g} {unit}/s^2 '
        if abs(coming[i]) > axes.velocity[i] * (1.0 + STATE_TOLERANCE) and coming[i] * q_ddot[i] > 0.0:
            raise PlanningError(
                f'{state}comes to {coming[i]:.6g} {unit}/s before its acceleration can end with a jerk of '
                f'{axes.jerk[i]:.6g} {unit}/s^3, its limit is {axes.velocity[i]:.6g} {unit}/s',
                joint=name,
                value=float(coming[i]),
                limit=float(axes.velocity[i]),
            )
        highest = furthest(q[i], q_dot[i], q_ddot[i], axes.acceleration[i], axes.jerk[i])
        lowest = -furthest(-q[i], -q_dot[i], -q_ddot[i], axes.acceleration[i], axes.jerk[i])
        for reached, limit, beyond in (
            (highest, axes.upper[i], highest - axes.upper[i]),
            (lowest, axes.lower[i], axes.lower[i] - lowest),
        ):
            if beyond > LIMIT_TOLERANCE:
                raise PlanningError(
                    f'{state}cannot stop before its limit {limit:.6g} {unit}: braking with all of its '
                    f'acceleration ({axes.acceleration[i]:.6g} {unit}/s^2) and jerk ({axes.jerk[i]:.6g} '
                    f'{unit}/s^3) takes it to {reached:.6g} {unit}',
                    joint=name,
                    value=float(reached),
                    limit=float(limit),
                )


def furthest(q: float, q_dot: float, q_ddot: float, acceleration: float, jerk: float) -> float:
    """The highest position of an axis that brakes upward motion as hard as it can, rad (m).

    Its acceleration falls at the jerk limit and then stays at the acceleration limit until the velocity is 0.
    An axis that has to rest there releases the brake earlier and goes slightly further.
    """
    square = q_ddot * q_ddot + 2.0 * jerk * q_dot
    if square <= 0.0 or (q_dot <= 0.0 and q_ddot <= 0.0):
        return q
    turns = (q_ddot + sqrt(square)) / jerk
    full = max((q_ddot + acceleration) / jerk, 0.0)
    t = min(turns, full)
    v = q_dot + t * (q_ddot - 0.5 * t * jerk)
    p = q + t * (q_dot + t * (0.5 * q_ddot - t * jerk / 6.0))
    if turns > full:
        p += 0.5 * v * v / acceleration
    return max(q, p)
