"""Trajectories of others: from waypoints with times to a Trajectory."""

from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

START_TOLERANCE = 1e-6  # rad (m), s; a first waypoint this near to the start is the start
MOST_JUMP = 0.05  # rad (m): a first waypoint at time 0 that is farther away is somewhere else


def trajectory_through(
    time: Array,
    position: Array,
    velocity: Array | None,
    acceleration: Array | None,
    start: Array,
) -> Trajectory:
    """The motion from rest at `start` through waypoints.

    As far as they are given, velocities and accelerations are passed exactly, with quintics in between, as in
    ros2_control. Positions alone are joined by the cubic spline with continuous acceleration that rests at
    both ends. Limits are not checked: `verify` does that.

    Args:
        time: From the start, (m,), s, increasing, from 0 or later.
        position: (m, n), rad (m).
        velocity: (m, n), rad/s; None if not given.
        acceleration: (m, n), rad/s^2; None if not given.
        start: Where the robot stands, (n,).

    Raises:
        InvalidInputError: no waypoint, times that do not increase, a first waypoint at time 0 that is not
            where the robot stands, or accelerations without velocities.
    """
    if len(time) == 0:
        raise InvalidInputError('a trajectory needs at least one point, got none')
    if time[0] < 0.0 or not (np.diff(time) > 0.0).all():
        raise InvalidInputError('times of trajectory points must be 0 or above and increase')
    if velocity is None and acceleration is not None:
        raise InvalidInputError('accelerations need velocities; give both, velocities alone, or none')
    offset = position[0] - start
    worst = int(np.abs(offset).argmax())
    if time[0] <= START_TOLERANCE:
        if abs(offset[worst]) > MOST_JUMP:
            raise InvalidInputError(
                f'the trajectory starts {offset[worst]:+.6g} from where axis {worst + 1} stands, allowed is '
                f'{MOST_JUMP:g}'
            )
        if len(time) == 1:
            raise InvalidInputError('a single point at time 0 is no motion; give a time to reach it')
        time, position = time[1:], position[1:]
        velocity = None if velocity is None else velocity[1:]
        acceleration = None if acceleration is None else acceleration[1:]
    rest = np.zeros((1, position.shape[1]))
    t = np.concatenate([[0.0], time])
    q = np.concatenate([start[None], position])
    if velocity is None:
        spline = _interpolate().CubicSpline(t, q, bc_type='clamped')
        v, a = spline(t, 1), spline(t, 2)
        v[[0, -1]] = 0.0  # except for rounding
    else:
        v = np.concatenate([rest, velocity])
        a = np.concatenate([rest, acceleration]) if acceleration is not None else _accelerations(t, q, v)
    a[0] = 0.0
    if not v[-1].any():
        a[-1] = 0.0
    return Trajectory(Trajectory.message_times(t), q, v, a)


def trajectory_from(
    time: Array, rows: Sequence[Array | None], start: Array, name: str, late: float = 0.0
) -> Trajectory:
    """The motion of a client's points; see `trajectory_through`.

    Args:
        time: From the start, (m,), s.
        rows: Positions, velocities and accelerations, (m, n) each; None if not given. Velocities alone are
            integrated.
        start: Where the robot stands, (n,).
        name: Of the trajectory, for messages.
        late: How long ago it should have begun, s: points before are left out.

    Raises:
        InvalidInputError: no points, all of them are past, or they make no motion.
    """
    if len(time) == 0:
        raise InvalidInputError(f'{name}: a trajectory needs at least one point, got none')
    if late > 0.0:
        if time[-1] <= late:
            raise InvalidInputError(f'{name}: the trajectory has ended {late - time[-1]:.6g} s ago')
        ahead = time > late
        time, rows = time[ahead] - late, [None if row is None else row[ahead] for row in rows]
    position, velocity, acceleration = rows
    if position is None:
        if velocity is None:
            raise InvalidInputError(f'{name}: points have neither positions nor velocities')
        position = positions_from_velocities(time, velocity, start)
    return trajectory_through(time, position, velocity, acceleration, start)


def positions_from_velocities(time: Array, velocity: Array, start: Array) -> Array:
    """Positions of waypoints (m, n), rad (m), whose velocities change linearly, from rest.

    Args:
        time: From the start, (m,), s, increasing.
        velocity: (m, n), rad/s (m/s).
        start: Where the robot stands, (n,).
    """
    t, v = np.concatenate([[0.0], time]), np.concatenate([np.zeros_like(velocity[:1]), velocity])
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(t)[:, None]
    positions: Array = start + np.cumsum(steps, axis=0)
    return positions


def _interpolate() -> ModuleType:
    return import_module('scipy.interpolate')  # imported on demand: most nodes get no such trajectories


def _accelerations(t: Array, q: Array, v: Array) -> Array:
    """Means of the accelerations that the cubics on both sides of a waypoint have there."""
    spline = _interpolate().CubicHermiteSpline(t, q, v, axis=0)
    after = spline(t, 2)
    before = spline(np.nextafter(t, 0.0), 2)
    mean: Array = 0.5 * (before + after)
    return mean
