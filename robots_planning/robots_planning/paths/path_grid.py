"""The grid along a path on which a speed profile is made."""

from __future__ import annotations

import numpy as np

from robots_core.validation import Array

POINTS = 200  # of the time that the path takes
TURN_POINTS = 50  # more per radian that the axes' direction turns
# Of the time: with this part of it the way grows as from and to rest at one acceleration, with the rest of it
# as at one speed.
ACCELERATED = 0.5
GROWTH = 0.1  # of the distance between points, from one to the next
END_PARTS = 4  # of the first and of the last interval
REST_NODES = 50  # at which the time is told in either half of the path, besides those given
SPLIT = 4  # parts of an interval that turned out to be too long
CLOSEST = 1e-9  # part of the path between nodes; closer ones are taken for one


def path_grid(coordinate: Array, duration: Array, turn: Array) -> Array:
    """Grid of a path's coordinate for a speed profile from rest to rest, (k,), from end to end.

    It is about even in time, finer where the axes' direction turns, and its spacing changes gradually: what
    limits a robot that comes out of a singularity changes over ever longer ways. The first interval and the
    last are split evenly in time from and to rest.

    Args:
        coordinate: Its values at nodes of the path, (m,), increasing.
        duration: Least time up to each node at full speed, (m,), in any unit.
        turn: By how much the direction of the axes has turned up to each node, (m,) rad.
    """
    way = duration / duration[-1]
    halves = 0.5 * np.linspace(0.0, 1.0, REST_NODES) ** 2
    nodes = np.union1d(way, np.concatenate([halves, 1.0 - halves]))
    nodes = nodes[np.append(True, np.diff(nodes) > CLOSEST)]
    time, turned = _time(nodes), np.interp(nodes, way, turn)

    steps = np.diff(time)
    spacing = 1.0 / (POINTS + TURN_POINTS * np.diff(turned) / steps)
    middle = 0.5 * GROWTH * (time[1:] + time[:-1])
    spacing = np.minimum.accumulate(spacing - middle) + middle
    spacing = np.minimum.accumulate((spacing + middle)[::-1])[::-1] - middle
    points = np.append(0.0, np.cumsum(steps / spacing))

    count = int(np.ceil(points[-1])) + 1
    grid = np.interp(np.linspace(0.0, points[-1], count), points, np.interp(nodes, way, coordinate))
    grid[-1] = coordinate[-1]
    # From and to rest the way grows with the square of time.
    squares = (np.arange(1, END_PARTS) / END_PARTS) ** 2
    first, last = grid[1] - grid[0], grid[-1] - grid[-2]
    begin, end = grid[0] + first * squares, grid[-1] - last * squares[::-1]
    return np.concatenate([grid[:1], begin, grid[1:-1], end, grid[-1:]])


def finer_grid(grid: Array, places: Array) -> Array:
    """The grid, (k,), with the intervals of some places, (m,) inside it, and those beside them split."""
    coarse = np.zeros(len(grid) + 1)
    index = np.clip(np.searchsorted(grid, places), 1, len(grid) - 1)
    for neighbour in (-1, 0, 1):
        coarse[index + neighbour] = 1.0
    parts = np.where(coarse[1:-1] > 0.0, SPLIT, 1)
    count = np.append(0, np.cumsum(parts))
    return np.interp(np.arange(count[-1] + 1), count, grid)


def _time(way: Array) -> Array:
    """About which part of the time has passed where a part of the way has, each from 0 to 1."""
    shorter = np.minimum(way, 1.0 - way)
    passed = (1.0 - ACCELERATED) * shorter + ACCELERATED * np.sqrt(0.5 * shorter)
    time: Array = np.where(way < 0.5, passed, 1.0 - passed)
    return time
