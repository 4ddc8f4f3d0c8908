"""Searches for approaches along a path that cannot miss any between samples.

In the middle of an interval of time the distances of all pairs of solids have proven lower bounds. The motion
of the axes within the interval bounds the approach of two solids. If that is less than their distance, the
pair is free in the whole interval; otherwise the interval is halved (adaptive dynamic
collision checking, Schwarzer, Saha and Latombe 2005).
"""

import heapq
from itertools import count

import numpy as np

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.blocks.collision.results import RESOLUTION
from robots_core.validation import Array

FIRST_SAMPLES = 17  # of the path, for a first bound of the smallest distance


def first_approach(solids: SolidSet, path: JointPath, since: float, margins: Array) -> float | None:
    """The first time from `since` on at which a pair may be closer than its margin, s; None if none ever is.

    There is a margin, m, for each pair of the solids, (p,).
    """
    found: float | None = None
    every = np.arange(len(margins))
    for end in (since, path.end):
        solids.place(path.sample(end))
        if (solids.distances(every, margins) <= margins).any():
            found = end
            break
    if found == since:
        return found
    waiting = [(since, path.end, every)]  # intervals, and the pairs that are not proven to be free in them
    while waiting:
        low, high, pairs = waiting.pop()
        middle = 0.5 * (low + high)
        lower, approach = _bounds(solids, path, (low, middle, high), pairs, margins[pairs])
        open_ = lower - approach <= margins[pairs]
        if not open_.any():
            continue
        before, after = (low, middle, pairs[open_]), (middle, high, pairs[open_])
        if (lower <= margins[pairs]).any():
            found, waiting = middle, []  # later intervals no longer matter
            if approach[open_].max() > RESOLUTION:
                waiting = [before]
        elif approach[open_].max() <= RESOLUTION:
            return middle
        else:
            waiting += [after, before]
    return found


def closest_approach(solids: SolidSet, path: JointPath, tolerance: float) -> tuple[float, float]:
    """The time of the smallest distance of any pair, s, and that distance, m.

    No distance on the path is smaller by more than `tolerance` (m).
    """
    every = np.arange(solids.first.size)
    best, time = np.inf, path.start
    for t in np.linspace(path.start, path.end, FIRST_SAMPLES):
        solids.place(path.sample(t))
        found, at = solids.smallest_distance(every, best)
        if at >= 0:
            best, time = found, float(t)
    order = count()  # breaks ties between equal bounds
    waiting = [(0.0, next(order), path.start, path.end, every)]
    while waiting and best > 0.0:
        bound, _, low, high, pairs = heapq.heappop(waiting)
        if bound >= best - tolerance:
            break
        middle = 0.5 * (low + high)
        lower, approach = _bounds(solids, path, (low, middle, high), pairs, np.full(pairs.size, best))
        if (lower < best).any():
            found, at = solids.smallest_distance(pairs, best)
            if at >= 0:
                best, time = found, middle
        bounds = lower - approach
        open_ = bounds < best - tolerance
        if open_.any():
            for begin, end in ((low, middle), (middle, high)):
                heapq.heappush(waiting, (float(bounds[open_].min()), next(order), begin, end, pairs[open_]))
    return time, best


def _bounds(
    solids: SolidSet, path: JointPath, interval: tuple[float, float, float], pairs: Indices, enough: Array
) -> tuple[Array, Array]:
    """Distances in the middle of an interval, and bounds on the approach within it, (k,) m each."""
    solids.place(path.sample(interval[1]))
    approach = solids.travels(pairs, path.turn(*interval))
    # Distances beyond the largest approach need not be exact.
    return solids.distances(pairs, enough + approach), approach
