# ruff: noqa: PLR0917  # compiled loops over arrays
"""Search for a free way between postures by two trees, compiled.

RRT-Connect (Kuffner and LaValle 2000) whose edges are all certified. Random numbers are integer arithmetic
(splitmix64; Steele, Lea and Flood 2014), and postures are made of sums and products alone, so that a search
does not depend on the speed of the machine, nor on a library's random numbers.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.collision.certificate_kernel import (
    FREE,
    BodyArrays,
    PlacedArrays,
    blocking_pair,
    certify_line,
)
from robots_core.blocks.collision.pair_kernels import Indices
from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

Tree = tuple[Array, Indices]
"""Postures (c, n), and the row that each was reached from, (c,), below 0 for a root; rows beyond are free."""
Random = NDArray[np.uint64]
"""State of a generator of random numbers, (1,)."""

PATIENCE = 3  # shortcuts in a row that are not free
RANGE = 1.2  # of one edge, in the weighted norm


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
    body: BodyArrays,
    placed: PlacedArrays,
    margins: Array,
    box: Array,
    domain: Array,
    weights: Array,
    trees: tuple[Tree, Tree],
    counts: Indices,
    blocked: Indices,
    closest: Array,
    random: Random,
    work: Indices,
    until: int,
) -> tuple[int, int]:
    """Grow both trees until they meet, are full, or enough postures were looked at.

    Args:
        body: The robot and its scene.
        placed: Scratch memory.
        margins: Distance that each pair keeps, (p,) m.
        box: Lowest and highest joint positions of start and targets, (2, n).
        domain: Lowest and highest posture of samples, (2, n), around these.
        weights: Of the axes in the norm, (n,).
        trees: From the start, and from the targets.
        counts: Their numbers of rows, (2,).
        blocked: Gets how often each pair blocked an edge, (p,).
        closest: Gets the smallest distance between the trees that was met, and the rows of both, (3,).
        random: Random numbers.
        work: Number of postures that were looked at.
        until: Value of `work` at which to return.

    Returns:
        Rows of both trees that a free line joins; -1, -1 if they have not met.
    """
    n = weights.size
    sample, new = np.empty(n), np.empty(n)
    capacity = min(trees[0][1].size, trees[1][1].size)
    while work[0] < until and counts.max() < capacity:
        a = 0 if counts[0] <= counts[1] else 1
        tree, other = trees[a], trees[1 - a]
        # More of them near the ends, where short ways are.
        reach = uniform(random)
        for axis in range(n):
            low = box[0, axis] + reach * (domain[0, axis] - box[0, axis])
            high = box[1, axis] + reach * (domain[1, axis] - box[1, axis])
            sample[axis] = low + (high - low) * uniform(random)
        work[0] += 1
        near, length = _nearest(tree, counts[a], weights, sample)
        part = min(1.0, RANGE / length) if length > 0.0 else 1.0
        new[:] = tree[0][near] + part * (sample - tree[0][near])
        # Its end alone decides most often, and takes one posture.
        pair = blocking_pair(body, placed, new, margins)
        if pair == FREE:
            pair, _ = certify_line(body, placed, tree[0][near], new, margins, work)
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
            pair, _ = certify_line(body, placed, other[0][at], sample, margins, work)
            if pair != FREE:
                blocked[pair] += 1
                break
            if part == 1.0:
                return (row, at) if a == 0 else (at, row)
            at = _add(other, counts, 1 - a, sample, at)
            length = distance(weights, sample, new)
    return -1, -1


@compiled()
def shorten(
    body: BodyArrays,
    placed: PlacedArrays,
    margins: Array,
    weights: Array,
    path: Array,
    tries: int,
    random: Random,
    work: Indices,
) -> Array:
    """A shorter free path through other postures, (k, n), by shortcuts (Geraerts and Overmars 2007).

    Args:
        body: The robot and its scene.
        placed: Scratch memory.
        margins: Distance that each pair keeps, (p,) m.
        weights: Of the axes in the norm that is made smaller, (n,).
        path: Postures, (m, n), with free lines between them.
        tries: Number of shortcuts that are tried at most, until `PATIENCE` in a row are not free.
        random: Random numbers.
        work: Number of postures that were looked at.
    """
    path = _without_detours(body, placed, margins, path, work)
    failed = 0
    for _ in range(tries):
        count = len(path)
        if count == 2 or failed == PATIENCE:
            break
        along = np.zeros(count)
        for row in range(1, count):
            along[row] = along[row - 1] + distance(weights, path[row - 1], path[row])
        low, high = along[-1] * uniform(random), along[-1] * uniform(random)
        low, high = min(low, high), max(low, high)
        i, j = 0, 0
        while i < count - 2 and along[i + 1] <= low:
            i += 1
        while j < count - 2 and along[j + 1] <= high:
            j += 1
        if i == j or along[i + 1] == along[i] or along[j + 1] == along[j]:
            continue
        first = path[i] + (low - along[i]) / (along[i + 1] - along[i]) * (path[i + 1] - path[i])
        last = path[j] + (high - along[j]) / (along[j + 1] - along[j]) * (path[j + 1] - path[j])
        failed += 1
        # The pieces that are left of both lines are parts of free ones.
        if certify_line(body, placed, first, last, margins, work)[0] == FREE:
            shorter = np.empty((i + 3 + count - 1 - j, path.shape[1]))
            shorter[: i + 1], shorter[i + 1], shorter[i + 2] = path[: i + 1], first, last
            shorter[i + 3 :] = path[j + 1 :]
            path = shorter
            failed = 0
    return _without_detours(body, placed, margins, path, work)


@compiled()
def _without_detours(
    body: BodyArrays, placed: PlacedArrays, margins: Array, path: Array, work: Indices
) -> Array:
    """The path without postures that a free line passes by, the farthest line first."""
    kept = np.zeros(len(path), dtype=np.int64)
    count, at = 1, 0
    while at < len(path) - 1:
        to = len(path) - 1
        while to > at + 1 and certify_line(body, placed, path[at], path[to], margins, work)[0] != FREE:
            to -= 1
        kept[count] = at = to
        count += 1
    return path[kept[:count]]
