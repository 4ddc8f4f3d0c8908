"""Searches along a path that cannot step over anything.

In the middle of an interval of time all pairs of solids have distances with proven lower bounds. What the
axes turn within the interval bounds how far two solids can approach each other in it. Where that is less than
their distance the pair is free in the whole interval; otherwise the interval is halved (adaptive dynamic
collision checking, Schwarzer, Saha and Latombe 2005).
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from itertools import count

import numpy as np

from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.collision.pair_kernels import Indices
from robots_core.blocks.collision.solid_set import SolidSet
from robots_core.validation import Array

RESOLUTION = 1e-4  # m
"""What comes closer to a margin than this may count as below it; what is below it never counts as free."""
FIRST_LOOK = 17


@dataclass(frozen=True)
class Interval:
    """A part of the path, and the pairs that are not known to be free in it."""

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
        solids: What moves.
        path: How it moves.
        since: Time to begin at, s.
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
        lower, way = _look(solids, path, interval, margins[interval.pairs])
        open_ = lower - way <= margins[interval.pairs]
        if not open_.any():
            continue
        before, after = interval.halves(interval.pairs[open_])
        if (lower <= margins[interval.pairs]).any():
            found, waiting = interval.middle, []  # what comes later does not matter any more
            if way[open_].max() > RESOLUTION:
                waiting = [before]
        elif way[open_].max() <= RESOLUTION:
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
    for t in np.linspace(path.start, path.end, FIRST_LOOK):
        solids.place(path.sample(t))
        found, at = solids.smallest_distance(every, best)
        if at >= 0:
            best, time = found, float(t)
    order = count()  # intervals of equal bounds are taken as they come
    waiting = [(0.0, next(order), Interval(path.start, path.end, every))]
    while waiting and best > 0.0:
        bound, _, interval = heapq.heappop(waiting)
        if bound >= best - tolerance:
            break
        lower, way = _look(solids, path, interval, np.full(interval.pairs.size, best))
        if (lower < best).any():
            found, at = solids.smallest_distance(interval.pairs, best)
            if at >= 0:
                best, time = found, interval.middle
        bounds = lower - way
        open_ = bounds < best - tolerance
        if open_.any():
            for half in interval.halves(interval.pairs[open_]):
                heapq.heappush(waiting, (float(bounds[open_].min()), next(order), half))
    return time, best


def _look(solids: SolidSet, path: JointPath, interval: Interval, enough: Array) -> tuple[Array, Array]:
    """Distances in the middle of an interval, and how far they can shrink within it, (k,) m each."""
    solids.place(path.sample(interval.middle))
    way = solids.travels(interval.pairs, path.turn(interval.low, interval.middle, interval.high))
    # A distance beyond what can be travelled need not be known exactly.
    return solids.distances(interval.pairs, enough + way), way
