# ruff: noqa: PLR0917, C901  # compiled loops over arrays
"""Search for a free path between postures by two trees, and its shortening, compiled.

RRT-Connect (Kuffner and LaValle 2000) whose edges are all certified. Random numbers are integer arithmetic
(splitmix64; Steele, Lea and Flood 2014), and postures are made of sums and products alone, so that a search
does not depend on the speed of the machine, nor on a library's random numbers.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.collision.along_paths.path_certificate import (
    FREE,
    PathCertificate,
    blocking_pair,
    certify_line,
)
from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

Tree = tuple[Array, Indices]
"""Postures (c, n), and the row that each was reached from, (c,), below 0 for a root; rows beyond are free."""
Random = NDArray[np.uint64]
"""State of a generator of random numbers, (1,)."""

RANGE = 1.2  # of one edge, in the weighted norm
STRAIGHT = 0.2  # of the axes of a sample, which lie where the straight line to a target has them
LARGEST_CUT = 0.49  # of a line at one of its ends that a rounded corner replaces; the rest separates corners
CORNER = 0.75  # curvature in the middle of a rounded corner, of the turn over the length that it cuts
SHORTCUTS = 0.4  # of all tries; the others move a posture
GAIN = 0.998  # of a duration; less is not worth a certificate
PROPOSALS = 10  # of a moved posture, of which the first that saves time is certified
# How far postures are moved at first, at least and at most, in seconds at the axes' highest speed, and the
# factors of that for a move that was free, was not, or was not found.
STEP, SMALLEST_STEP, LARGEST_STEP = 0.1, 0.003, 0.3
MOVED, BLOCKED, NOT_FOUND = 1.5, 0.85, 0.7


@compiled()
def uniform(random: Random) -> float:
    """A random number in [0, 1)."""
    random[0] += np.uint64(0x9E3779B97F4A7C15)
    z = random[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z ^= z >> np.uint64(31)
    return float(z >> np.uint64(11)) * 2.0**-53


@compiled()
def distance(weights: Array, first: Array, second: Array) -> float:
    """Weighted Euclidean distance of two postures, (n,) each."""
    total = 0.0
    for axis in range(weights.size):
        way = weights[axis] * (first[axis] - second[axis])
        total += way * way
    return sqrt(total)


@compiled()
def _nearest(tree: Tree, count: int, weights: Array, q: Array) -> tuple[int, float]:
    """The row of the tree that is nearest to a posture, and its distance."""
    best, at = inf, 0
    nodes = tree[0]
    for row in range(count):
        total = 0.0
        for axis in range(weights.size):
            way = weights[axis] * (nodes[row, axis] - q[axis])
            total += way * way
        if total < best:
            best, at = total, row
    return at, sqrt(best)


@compiled()
def _add(tree: Tree, counts: Indices, which: int, q: Array, parent: int) -> int:
    row = int(counts[which])
    tree[0][row], tree[1][row] = q, parent
    counts[which] += 1
    return row


@compiled()
def grow(
    certificate: PathCertificate,
    ends: Array,
    box: Array,
    domain: Array,
    weights: Array,
    trees: tuple[Tree, Tree],
    counts: Indices,
    blocked: Indices,
    closest: Array,
    random: Random,
    until: int,
) -> tuple[int, int]:
    """Grow both trees until they meet, are full, or enough postures were checked.

    Args:
        certificate: Of the robot in its scene.
        ends: Start and targets, (1 + k, n).
        box: Lowest and highest joint positions of these, (2, n).
        domain: Lowest and highest posture of samples, (2, n), around the box.
        weights: Of the axes in the norm, (n,).
        trees: From the start, and from the targets.
        counts: Their numbers of rows, (2,).
        blocked: Gets how often each pair blocked an edge, (p,).
        closest: Gets the smallest distance between the trees that was met, and the rows of both, (3,).
        random: Random numbers.
        until: Number of postures that were checked at which to return.

    Returns:
        Rows of both trees that a free line joins; -1, -1 if they have not met.
    """
    n, work = weights.size, certificate.work
    sample, new = np.empty(n), np.empty(n)
    capacity = min(trees[0][1].size, trees[1][1].size)
    while work[0] < until and counts.max() < capacity:
        a = 0 if counts[0] <= counts[1] else 1
        tree, other = trees[a], trees[1 - a]
        # More of them near the ends and with some axes on the straight line, where short paths are.
        reach, along = uniform(random), uniform(random)
        target = 1 + int((len(ends) - 1) * uniform(random))
        for axis in range(n):
            if uniform(random) < STRAIGHT:
                sample[axis] = ends[0, axis] + along * (ends[target, axis] - ends[0, axis])
                continue
            low = box[0, axis] + reach * (domain[0, axis] - box[0, axis])
            high = box[1, axis] + reach * (domain[1, axis] - box[1, axis])
            sample[axis] = low + (high - low) * uniform(random)
        work[0] += 1
        near, length = _nearest(tree, counts[a], weights, sample)
        part = min(1.0, RANGE / length) if length > 0.0 else 1.0
        new[:] = tree[0][near] + part * (sample - tree[0][near])
        # Its end alone decides most often, and takes one posture.
        pair = blocking_pair(certificate, new)
        if pair == FREE:
            pair, _ = certify_line(certificate, tree[0][near], new)
        if pair != FREE:
            blocked[pair] += 1
            continue
        row = _add(tree, counts, a, new, near)
        # From the other tree straight there, as far as it is free.
        at, length = _nearest(other, counts[1 - a], weights, new)
        while counts[1 - a] < capacity:
            if length < closest[0]:
                closest[0], closest[1 + a], closest[2 - a] = length, row, at
            part = min(1.0, RANGE / length) if length > 0.0 else 1.0
            if part == 1.0:
                sample[:] = new
            else:
                sample[:] = other[0][at] + part * (new - other[0][at])
            pair, _ = certify_line(certificate, other[0][at], sample)
            if pair != FREE:
                blocked[pair] += 1
                break
            if part == 1.0:
                return (row, at) if a == 0 else (at, row)
            at = _add(other, counts, 1 - a, sample, at)
            length = distance(weights, sample, new)
    return -1, -1


@compiled()
def duration(axes: Array, path: Array) -> float:
    """About the time, s, that a path through postures takes from rest to rest, its corners rounded.

    Speed and acceleration limits hold on the lines and in the middle of the corners; torques are left out.

    Args:
        axes: See `shorten`.
        path: Postures, (k, n); infinite where two in a row are equal.
    """
    count, n = path.shape
    lengths, top, acceleration = np.empty(count - 1), np.empty(count - 1), np.empty(count - 1)
    directions, u = np.empty((count - 1, n)), np.zeros(count)  # u: squares of speeds
    for k in range(count - 1):
        squared = 0.0
        for axis in range(n):
            directions[k, axis] = path[k + 1, axis] - path[k, axis]
            squared += directions[k, axis] ** 2
        lengths[k] = sqrt(squared)
        if lengths[k] == 0.0:
            return inf
        top[k] = acceleration[k] = inf
        for axis in range(n):
            directions[k, axis] /= lengths[k]
            part = abs(directions[k, axis])
            if part > 0.0:
                top[k] = min(top[k], (axes[2, axis] / part) ** 2)
                acceleration[k] = min(acceleration[k], axes[3, axis] / part)
        if k > 0:
            u[k] = min(top[k - 1], top[k], u[k - 1] + 2.0 * acceleration[k - 1] * lengths[k - 1])
            cut = LARGEST_CUT * min(lengths[k - 1], lengths[k])
            for axis in range(n):
                turn = abs(directions[k, axis] - directions[k - 1, axis])
                if turn > 0.0:
                    u[k] = min(u[k], axes[3, axis] * cut / (CORNER * turn))
    total = 0.0
    for k in range(count - 2, -1, -1):
        if k > 0:
            u[k] = min(u[k], u[k + 1] + 2.0 * acceleration[k] * lengths[k])
        peak = min(top[k], 0.5 * (u[k] + u[k + 1]) + acceleration[k] * lengths[k])
        fast = sqrt(peak)
        steady = lengths[k] - (2.0 * peak - u[k] - u[k + 1]) / (2.0 * acceleration[k])
        total += (2.0 * fast - sqrt(u[k]) - sqrt(u[k + 1])) / acceleration[k] + max(steady, 0.0) / fast
    return total


@compiled()
def shorten(
    certificate: PathCertificate, axes: Array, path: Array, tries: int, most: int, random: Random
) -> Array:
    """A free path through other postures, (k, n), that takes less time.

    Shortcuts (Geraerts and Overmars 2007) and moved postures, each kept where it makes `duration` smaller and
    is free. Postures are moved by steps that adapt, as in a (1+1) evolution strategy.

    Args:
        certificate: Of the robot in its scene.
        axes: Lower and upper limits of the axes, highest speeds and accelerations, (4, n).
        path: Postures, (m, n), with free lines between them.
        tries: Number of changes that are tried.
        most: Number of postures after which no more are tried.
        random: Random numbers.
    """
    path, work = _without_detours(certificate, path), certificate.work
    n, step, time, until = path.shape[1], STEP, duration(axes, path), work[0] + most
    for _ in range(tries):
        count = len(path)
        if count == 2 or work[0] >= until:
            break
        if uniform(random) < SHORTCUTS:
            low, high = (count - 1) * uniform(random), (count - 1) * uniform(random)
            low, high = min(low, high), max(low, high)
            i, j = int(low), int(high)
            if i == j:
                continue
            changed = np.empty((i + 2 + count - j, n))
            changed[: i + 1], changed[i + 3 :] = path[: i + 1], path[j + 1 :]
            changed[i + 1] = path[i] + (low - i) * (path[i + 1] - path[i])
            changed[i + 2] = path[j] + (high - j) * (path[j + 1] - path[j])
            new = duration(axes, changed)
            # The pieces that are left of both lines are parts of free ones.
            if new < GAIN * time and certify_line(certificate, changed[i + 1], changed[i + 2])[0] == FREE:
                path, time = changed, new
            continue
        k, changed, new = 1 + int((count - 2) * uniform(random)), path.copy(), inf
        for _ in range(PROPOSALS):
            for axis in range(n):
                moved = path[k, axis] + step * axes[2, axis] * (2.0 * uniform(random) - 1.0)
                changed[k, axis] = min(max(moved, axes[0, axis]), axes[1, axis])
            new = duration(axes, changed)
            if new < GAIN * time:
                break
        if new >= GAIN * time:
            step = max(NOT_FOUND * step, SMALLEST_STEP)
            continue
        work[0] += 1
        if (
            blocking_pair(certificate, changed[k]) == FREE
            and certify_line(certificate, path[k - 1], changed[k])[0] == FREE
            and certify_line(certificate, changed[k], path[k + 1])[0] == FREE
        ):
            path, time = changed, new
            step = min(MOVED * step, LARGEST_STEP)
        else:
            step = max(BLOCKED * step, SMALLEST_STEP)
    return path


@compiled()
def _without_detours(certificate: PathCertificate, path: Array) -> Array:
    """The path without postures that a free line passes by, the farthest line first."""
    kept = np.zeros(len(path), dtype=np.int64)
    count, at = 1, 0
    while at < len(path) - 1:
        to = len(path) - 1
        while to > at + 1 and certify_line(certificate, path[at], path[to])[0] != FREE:
            to -= 1
        kept[count] = at = to
        count += 1
    return path[kept[:count]]
