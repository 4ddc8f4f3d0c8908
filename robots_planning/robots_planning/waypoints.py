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
    time: Array, rows: Sequence[Array | None], start: Array, *, late: float = 0.0
) -> Trajectory:
    """The motion from rest at `start` through waypoints.

    As far as they are given, velocities and accelerations are passed exactly, with quintics in between, as in
    ros2_control. Positions alone are joined by the cubic spline with continuous acceleration that rests at
    both ends. Velocities alone change linearly. Limits are not checked: `verify` does that.

    Args:
        time: From the start, (m,), s, increasing, from 0 or later.
        rows: Positions, rad (m), velocities and accelerations, (m, n) each; None if not given.
        start: Where the robot stands, (n,).
        late: How long ago the motion should have begun, s: waypoints before are left out.

    Raises:
        InvalidInputError: no waypoint or none that is not past, times that do not increase, a first waypoint
            at time 0 that is not where the robot stands, accelerations without velocities, or neither
            positions nor velocities.
    """
    if len(time) == 0 or time[0] < 0.0 or not (np.diff(time) > 0.0).all():
        raise InvalidInputError(
            f'a trajectory needs at least one point, got {len(time)}; times must be 0 or above and increase'
        )
    if late > 0.0:
        time, rows = _ahead(time, rows, late)
    position, velocity, acceleration = rows
    if velocity is None:
        if position is None:
            raise InvalidInputError('points have neither positions nor velocities')
        if acceleration is not None:
            raise InvalidInputError('accelerations need velocities; give both, velocities alone, or none')
    elif position is None:
        position = _integrated(time, velocity, start)
    if time[0] <= START_TOLERANCE:
        _check_start(position[0] - start, len(time))
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


def _ahead(time: Array, rows: Sequence[Array | None], late: float) -> tuple[Array, list[Array | None]]:
    if time[-1] <= late:
        raise InvalidInputError(f'the trajectory has ended {late - time[-1]:.6g} s ago')
    ahead = time > late
    return time[ahead] - late, [None if row is None else row[ahead] for row in rows]


def _check_start(offset: Array, count: int) -> None:
    """Pass a first waypoint at time 0, so far from the start, (n,), of a number of waypoints."""
    worst = int(np.abs(offset).argmax())
    if abs(offset[worst]) > MOST_JUMP:
        raise InvalidInputError(
            f'the trajectory starts {offset[worst]:+.6g} from where axis {worst + 1} stands, allowed is '
            f'{MOST_JUMP:g}'
        )
    if count == 1:
        raise InvalidInputError('a single point at time 0 is no motion; give a time to reach it')


def _integrated(time: Array, velocity: Array, start: Array) -> Array:
    """Positions of waypoints, (m, n), whose velocities change linearly, from rest."""
    v = np.concatenate([np.zeros_like(velocity[:1]), velocity])
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(time, prepend=0.0)[:, None]
    return np.asarray(start + np.cumsum(steps, axis=0))


def _interpolate() -> ModuleType:
    return import_module('scipy.interpolate')  # imported on demand: most nodes get no such trajectories


def _accelerations(t: Array, q: Array, v: Array) -> Array:
    """Means of the accelerations that the cubics on both sides of a waypoint have there."""
    spline = _interpolate().CubicHermiteSpline(t, q, v, axis=0)
    after = spline(t, 2)
    before = spline(np.nextafter(t, 0.0), 2)
    mean: Array = 0.5 * (before + after)
    return mean
