"""Searches for approaches along a path that cannot miss any between samples.

In the middle of an interval of time the distances of all pairs of solids have proven lower bounds. The motion
of the axes within the interval bounds the approach of two solids. If that is less than their distance, the
pair is free in the whole interval; otherwise the interval is halved (adaptive dynamic
collision checking, Schwarzer, Saha and Latombe 2005).
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from itertools import count

import numpy as np

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.validation import Array

RESOLUTION = 1e-4  # m
"""A distance within this of the margin may count as below it; one below it never counts as free."""
FIRST_SAMPLES = 17  # of the path, for a first bound of the smallest distance


@dataclass(frozen=True)
class Interval:
    """A part of the path, and the pairs that are not proven to be free in it."""

    low: float
    high: float
    pairs: Indices

    @property
    def middle(self) -> float:
        """Its middle, s."""
        return 0.5 * (self.low + self.high)

    def halves(self, pairs: Indices) -> tuple[Interval, Interval]:
        """The earlier and the later half, with the pairs that are left."""
        return Interval(self.low, self.middle, pairs), Interval(self.middle, self.high, pairs)


def first_approach(solids: SolidSet, path: JointPath, since: float, margins: Array) -> float | None:
    """The first time at which a pair may be closer than its margin, s; None if none ever is.

    Args:
        solids: The solids.
        path: The motion.
        since: Start time, s.
        margins: (p,) m, one per pair.
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
    waiting = [Interval(since, path.end, every)]
    while waiting:
        interval = waiting.pop()
        lower, approach = _bounds(solids, path, interval, margins[interval.pairs])
        open_ = lower - approach <= margins[interval.pairs]
        if not open_.any():
            continue
        before, after = interval.halves(interval.pairs[open_])
        if (lower <= margins[interval.pairs]).any():
            found, waiting = interval.middle, []  # later intervals no longer matter
            if approach[open_].max() > RESOLUTION:
                waiting = [before]
        elif approach[open_].max() <= RESOLUTION:
            return interval.middle
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
    waiting = [(0.0, next(order), Interval(path.start, path.end, every))]
    while waiting and best > 0.0:
        bound, _, interval = heapq.heappop(waiting)
        if bound >= best - tolerance:
            break
        lower, approach = _bounds(solids, path, interval, np.full(interval.pairs.size, best))
        if (lower < best).any():
            found, at = solids.smallest_distance(interval.pairs, best)
            if at >= 0:
                best, time = found, interval.middle
        bounds = lower - approach
        open_ = bounds < best - tolerance
        if open_.any():
            for half in interval.halves(interval.pairs[open_]):
                heapq.heappush(waiting, (float(bounds[open_].min()), next(order), half))
    return time, best


def _bounds(solids: SolidSet, path: JointPath, interval: Interval, enough: Array) -> tuple[Array, Array]:
    """Distances in the middle of an interval, and bounds on the approach within it, (k,) m each."""
    solids.place(path.sample(interval.middle))
    approach = solids.travels(interval.pairs, path.turn(interval.low, interval.middle, interval.high))
    # Distances beyond the largest approach need not be exact.
    return solids.distances(interval.pairs, enough + approach), approach
