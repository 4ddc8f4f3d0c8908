"""The grid along a path on which a speed profile is made."""

import numpy as np

from robots_core.validation import Array

POINTS = 200  # over the duration of the path
TURN_POINTS = 50  # additional points per radian by which the axes' direction turns
# The time law that spaces the points: this part of it is a motion from rest to rest at constant acceleration,
# the rest one at constant speed.
ACCELERATED = 0.5
GROWTH = 0.1  # of the spacing, from one interval to the next
END_PARTS = 4  # into which the first and the last interval are split
REST_NODES = 50  # further nodes of the time law in either half of the path
SPLIT = 4  # parts into which an interval that is too long is split
CLOSEST = 1e-9  # of the path; nodes closer than this are merged
NEAR = 0.25  # of an interval, between a point and a place that replaces it


def path_grid(coordinate: Array, duration: Array, turn: Array) -> Array:
    """Grid of a path's coordinate for a speed profile from rest to rest, (k,), from end to end.

    Points are about equidistant in time, closer where the axes' direction turns, and the spacing changes
    gradually, as the active limits do behind a singularity. The first and the last interval are split evenly
    in time for constant acceleration from and to rest.

    Args:
        coordinate: Values of the path coordinate at nodes, (m,), increasing.
        duration: Least time up to each node at full speed, (m,), in any unit.
        turn: Accumulated turn of the axes' direction up to each node, (m,) rad.
    """
    distance = duration / duration[-1]
    halves = 0.5 * np.linspace(0.0, 1.0, REST_NODES) ** 2
    nodes = np.union1d(distance, np.concatenate([halves, 1.0 - halves]))
    nodes = nodes[np.append(True, np.diff(nodes) > CLOSEST)]
    time, turned = _time(nodes), np.interp(nodes, distance, turn)

    steps = np.diff(time)
    spacing = 1.0 / (POINTS + TURN_POINTS * np.diff(turned) / steps)
    middle = 0.5 * GROWTH * (time[1:] + time[:-1])
    spacing = np.minimum.accumulate(spacing - middle) + middle
    spacing = np.minimum.accumulate((spacing + middle)[::-1])[::-1] - middle
    points = np.append(0.0, np.cumsum(steps / spacing))

    count = int(np.ceil(points[-1])) + 1
    grid = np.interp(np.linspace(0.0, points[-1], count), points, np.interp(nodes, distance, coordinate))
    grid[-1] = coordinate[-1]
    # From and to rest the distance grows with the square of time.
    squares = (np.arange(1, END_PARTS) / END_PARTS) ** 2
    first, last = grid[1] - grid[0], grid[-1] - grid[-2]
    begin, end = grid[0] + first * squares, grid[-1] - last * squares[::-1]
    return np.concatenate([grid[:1], begin, grid[1:-1], end, grid[-1:]])


def with_places(grid: Array, places: Array) -> Array:
    """The grid, (k,), with further places, (m,), in it; points that nearly coincide with one are left out."""
    inner = places[(places > grid[0] + CLOSEST) & (places < grid[-1] - CLOSEST)]
    if not inner.size:
        return grid
    after = np.searchsorted(grid, inner)
    near = NEAR * (grid[after] - grid[after - 1])
    left_out = np.append(after[grid[after] - inner < near], after[inner - grid[after - 1] < near] - 1)
    inside = left_out[(left_out > 0) & (left_out < len(grid) - 1)]
    return np.union1d(np.delete(grid, inside), inner)


def finer_grid(grid: Array, places: Array) -> Array:
    """The grid, (k,), with the intervals that contain `places`, (m,), and their neighbours split."""
    coarse = np.zeros(len(grid) + 1)
    index = np.clip(np.searchsorted(grid, places), 1, len(grid) - 1)
    for neighbour in (-1, 0, 1):
        coarse[index + neighbour] = 1.0
    parts = np.where(coarse[1:-1] > 0.0, SPLIT, 1)
    count = np.append(0, np.cumsum(parts))
    return np.interp(np.arange(count[-1] + 1), count, grid)


def _time(distance: Array) -> Array:
    """Approximate part of the time at a part of the distance, each from 0 to 1."""
    shorter = np.minimum(distance, 1.0 - distance)
    passed = (1.0 - ACCELERATED) * shorter + ACCELERATED * np.sqrt(0.5 * shorter)
    time: Array = np.where(distance < 0.5, passed, 1.0 - passed)
    return time
