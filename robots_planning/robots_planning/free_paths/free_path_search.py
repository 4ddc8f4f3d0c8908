"""FreePathSearch: a certified path between postures around all obstacles."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.collision.along_paths.path_certificate import FREE, PathCertificate
from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.validation import Array
from robots_planning.free_paths.errors import NoFreePathError, SearchCancelledError
from robots_planning.free_paths.search_kernel import Random, Tree, duration, grow, shorten

POSTURES_PER_SECOND: Final = 25_000
"""What a search checks in a second of its budget; one posture takes 5 to 10 us on an AMD EPYC core."""
PAIRS: Final = 8000  # of solids that a posture of the budget has at most; one with more counts as several
SLICE: Final = 500  # postures that are checked before a cancellation is seen, 5 ms
CAPACITY: Final = 1024  # rows of a tree at first
# Changes of a path that are tried to make it take less time, and postures after which no more are: at first,
# to compare it with another one, and afterwards.
FIRST_CHANGES: Final = 20, 400
CHANGES: Final = 60, 1100
DETOUR: Final = 1.8  # of the straight motion's time; a path that takes longer is worth a second search,
SECOND_SEARCH: Final = 1500  # which may check so many postures
MOST_BLOCKING: Final = 3  # pairs that a refusal names
# How far beyond start and target postures are sampled, rad (m): close by first, where short paths are, and
# farther away with the number of postures in vain.
AROUND, WIDEST = 1.0, np.pi
TWICE_AS_WIDE: Final = 1000  # postures


@dataclass(frozen=True, eq=False)
class FreePath:
    """Postures with certified lines between them, (k, n) rad (m), from start to target; k >= 2."""

    postures: Array
    certificate: PathCertificate


class FreePathSearch:
    """Searches with two trees whose edges are certified, and makes what it finds take less time.

    The result depends on start, targets, scene, margin and seed alone: the budget counts postures, not time,
    the speed limits are the robot's own, and what is computed of angles decides only between yes and no.

    A detour is searched for once more, in a small part of the budget, and the faster of both paths is kept.

    Args:
        detection: Of the robot in its scene.
        margin: Distance that the path keeps, m, from 0.
        budget: Longest search, s, at `POSTURES_PER_SECOND`.
        seed: Of the random numbers, from 0.
    """

    def __init__(
        self,
        detection: CollisionDetection,
        *,
        margin: float,
        budget: float,
        seed: int = 0,
    ) -> None:
        axes = self._axes = detection.robot.axes_data
        self._limits = np.array([axes.lower, axes.upper, axes.velocity, axes.acceleration])
        self._detection, self._margin = detection, margin
        self._budget, self._seed = budget, seed
        # In this norm, a path's length is about its time.
        self._weights = axes.velocity.max() / axes.velocity

    def path(self, start: Array, targets: Array, cancelled: Callable[[], bool] = lambda: False) -> FreePath:
        """A fast path from a free posture to one of several, the first that a free line leads to if any.

        Args:
            start: (n,) rad (m).
            targets: Free postures, (k, n), k >= 1.
            cancelled: Whether to give up; asked every few milliseconds.

        Raises:
            NoFreePathError: none was found; names the bodies in the way and how close the search came.
            SearchCancelledError: it was given up.
        """
        certificate = self._detection.certificate(start, margin=self._margin)
        for target in targets:
            if certificate.line(start, target) == FREE:
                return FreePath(np.array([start, target]), certificate)
        return self.path_around(start, targets, cancelled)

    def path_around(
        self, start: Array, targets: Array, cancelled: Callable[[], bool] = lambda: False
    ) -> FreePath:
        """`path` where no line is free: arguments and errors as there."""
        certificate = self._detection.certificate(start, margin=self._margin)
        ends = np.vstack([start, targets])
        random: Random = np.array([self._seed], dtype=np.uint64)

        def found(budget: float) -> Array:
            path = self._searched(certificate, ends, random, cancelled, budget)
            return self._shortened(certificate, path, FIRST_CHANGES, random)

        path = found(self._budget)
        if self._time(path) > DETOUR * self._time(path[[0, -1]]):
            budget = min(self._budget, SECOND_SEARCH / POSTURES_PER_SECOND)
            with suppress(NoFreePathError):
                path = min(path, found(budget), key=self._time)
        return FreePath(self._shortened(certificate, path, CHANGES, random), certificate)

    def _time(self, path: Array) -> float:
        """About the time, s, that a path through postures (k, n) takes."""
        return float(duration(self._limits, path))

    def _shortened(
        self, certificate: PathCertificate, path: Array, changes: tuple[int, int], random: Random
    ) -> Array:
        """The path after a number of changes that make it take less time, of so many postures at most."""
        tries, most = changes[0], int(changes[1] / _crowd(certificate))
        return shorten(certificate, self._limits, path, tries, most, random)

    def _searched(
        self,
        certificate: PathCertificate,
        ends: Array,
        random: Random,
        cancelled: Callable[[], bool],
        budget: float,
    ) -> Array:
        """Postures with free lines between them; `ends` are the start and the targets."""
        work, crowd = certificate.work, _crowd(certificate)
        work[0] = 0
        trees = _tree(ends[:1], CAPACITY), _tree(ends[1:], CAPACITY)
        counts: Indices = np.array([1, len(ends) - 1])
        blocked: Indices = np.zeros(certificate.margins.size, dtype=np.int64)
        closest = np.array([np.inf, 0.0, 0.0])
        box = np.array([ends.min(axis=0), ends.max(axis=0)])
        most, step = int(budget * POSTURES_PER_SECOND / crowd), max(int(SLICE / crowd), 1)
        while work[0] < most:
            if cancelled():
                raise SearchCancelledError('given up while a path around obstacles was searched for')
            a, b = grow(
                certificate,
                ends,
                box,
                self._domain(box, int(work[0])),
                self._weights,
                trees,
                counts,
                blocked,
                closest,
                random,
                min(int(work[0]) + step, most),
            )
            if a >= 0:
                return np.concatenate([_branch(trees[0], a)[::-1], _branch(trees[1], b)])
            capacity = len(trees[0][1])
            if int(counts.max()) >= capacity - 1:
                trees = (
                    _tree(trees[0][0], 2 * capacity, trees[0][1]),
                    _tree(trees[1][0], 2 * capacity, trees[1][1]),
                )
        raise self._none(trees, blocked, closest)

    def _domain(self, box: Array, work: int) -> Array:
        """Lowest and highest posture of samples, (2, n), inside the limits, after `work` postures."""
        around = min(AROUND * (1.0 + work / TWICE_AS_WIDE), WIDEST)
        low = np.maximum(self._axes.lower, box[0] - around)
        return np.array([low, np.minimum(self._axes.upper, box[1] + around)])

    def _none(self, trees: tuple[Tree, Tree], blocked: Indices, closest: Array) -> NoFreePathError:
        names: dict[tuple[str, str], int] = {}
        for pair in np.flatnonzero(blocked):
            pair_names = self._detection.names(int(pair))
            names[pair_names] = names.get(pair_names, 0) + int(blocked[pair])
        most = sorted(names, key=lambda pair: -names[pair])[:MOST_BLOCKING]
        apart = np.abs(trees[0][0][int(closest[1])] - trees[1][0][int(closest[2])])
        axis = int(np.argmax(apart))
        name, unit = self._axes.names[axis], self._axes.unit(axis)
        blocking = ', '.join(f'{a} by {b}' for a, b in most)
        return NoFreePathError(
            f'no free path found within a budget of {self._budget:g} s: the searches from start and target '
            f'come within {apart[axis]:.4g} {unit} of {name}; most often blocked is {blocking or "nothing"}',
            joint=name,
            gap=float(apart[axis]),
            blocking='; '.join(f'{a} - {b}' for a, b in most),
        )


def _crowd(certificate: PathCertificate) -> float:
    """How many postures of the budget one with so many pairs counts as."""
    return max(1.0, certificate.margins.size / PAIRS)


def _tree(postures: Array, capacity: int, parents: Indices | None = None) -> Tree:
    """A tree with these postures first."""
    rows, parent = np.empty((capacity, postures.shape[1])), np.full(capacity, -1, dtype=np.int64)
    rows[: len(postures)] = postures
    if parents is not None:
        parent[: len(parents)] = parents
    return rows, parent


def _branch(tree: Tree, row: int) -> Array:
    """Postures from a row to its root, (k, n)."""
    rows = []
    while row >= 0:
        rows.append(tree[0][row])
        row = int(tree[1][row])
    return np.array(rows)
