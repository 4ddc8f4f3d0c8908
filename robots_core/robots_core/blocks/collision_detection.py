"""CollisionDetection: contacts and distances of a robot with itself and its surroundings."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.collision.allowed_pair_sampling import allowed_pairs_of, proven_apart
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.along_paths.path_certificate import PathCertificate
from robots_core.blocks.collision.along_paths.path_search import closest_approach, first_approach
from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.blocks.collision.engine import CoalEngine, CollisionEngine, FclEngine
from robots_core.blocks.collision.results import RESOLUTION, CollisionError, PathProximity, Proximity
from robots_core.blocks.collision.robot_solids import held_solids, robot_solids
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision.solids import Solid, solids_of
from robots_core.errors import InvalidInputError
from robots_core.robot_model.allowed_pairs import AllowedPairs
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, one_of, positive, read_only

ENGINES: Final[dict[str, type[CollisionEngine]]] = {'fcl': FclEngine, 'coal': CoalEngine}

# Of a cell, m: with none a robot touches what it passes, with much none moves.
MARGINS: Final = (5e-4, 0.5)
ROUNDING = 1e-6  # m, far above what the computed distances of one posture differ by
# Pairs of an attached object and a link with at most so many axes between them are excluded if proven apart.
NEAR_AXES = 2
NEAR_BUDGET = 300  # joint positions evaluated for that proof


class CollisionDetection:
    """Contacts and distances of a robot and its attached objects, with itself and with obstacles.

    The engine answers whether two bodies are in contact. Distances, those along whole paths too, are the
    results of a compiled search with a proof: the nearest points lie on the two bodies, and a separating
    plane shows that nothing is closer (see `nearest_points`). An instance keeps scratch memory: use one per
    thread.

    Args:
        robot: The robot. Shapes fixed to its base frame may touch obstacles, on which it stands.
        scene: Obstacles and attached objects.
        engine: Of contacts: 'fcl' (python-fcl) or 'coal'.
        allowed_pairs: Pairs of the robot's shapes that are not checked; by default those stored with the
            robot, or found by sampling.

    Raises:
        InvalidInputError: an unknown engine, or a scene whose `may_touch` has an unknown name.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        scene: Scene | None = None,
        engine: str = 'fcl',
        allowed_pairs: AllowedPairs | None = None,
    ) -> None:
        self.robot = robot
        self._engine_type = ENGINES[one_of('engine', ENGINES)(engine)]
        self._body = robot_solids(robot)
        self.allowed_pairs = allowed_pairs_of(robot) if allowed_pairs is None else allowed_pairs
        self.set_scene(Scene() if scene is None else scene)

    @property
    def scene(self) -> Scene:
        """The current scene."""
        return self._scene

    @property
    def blind(self) -> bool:
        """There are obstacles, and neither the robot nor what it holds has a body that could meet them."""
        return bool(self._scene.objects) and self._set.first.size == 0

    def set_scene(self, scene: Scene) -> None:
        """Replace all obstacles and attached objects.

        Raises:
            InvalidInputError: `may_touch` has an unknown name, or an object has the name of a shape of the
                robot.
        """
        self._check_names(scene)
        around = [
            solid for item in scene.objects for solid in solids_of(item.name, item.geometry, 0, item.pose)
        ]
        held = held_solids(self.robot, scene)
        solids = (*self._body, *held, *around)
        links = len(self._body)
        obstacles = {item.name for item in scene.objects}

        def checked(i: int, j: int) -> bool:
            a, b = solids[i], solids[j]
            if a.frame == b.frame or a.name == b.name or (a.name in obstacles and b.name in obstacles):
                return False
            if i < links and j < links:
                return not self.allowed_pairs.allows(a.name, b.name)
            return not scene.allows(a.name, b.name)

        pairs = [(i, j) for i in range(len(solids)) for j in range(i + 1, len(solids)) if checked(i, j)]
        self._set = self._without_held_apart(solids, pairs, {item.name for item in scene.attached})
        self._work: Indices = np.zeros(1, dtype=np.int64)
        self._engine = self._engine_type(solids)
        self._surfaces = np.array([not solid.convex and solid.closed for solid in solids], dtype=bool)
        self._with_surface = np.flatnonzero(
            self._surfaces[self._set.first] | self._surfaces[self._set.second]
        )
        self._scene = scene

    def with_scene(self, scene: Scene) -> CollisionDetection:
        """Another instance with its own scratch memory, of the same robot in another scene.

        Raises:
            InvalidInputError: as `set_scene`.
        """
        other = copy(self)
        other.set_scene(scene)
        return other

    def _without_held_apart(
        self, solids: Sequence[Solid], pairs: list[tuple[int, int]], held: set[str]
    ) -> SolidSet:
        """The pairs without those of attached objects and near links that can never be in contact.

        As with pairs of the robot itself: a tool is always close to the wrist, which would hide other
        distances.
        """
        near = self.robot.num_axes - NEAR_AXES
        doubtful = [(i, j) for i, j in pairs if solids[j].name in held and solids[i].frame >= max(near, 1)]
        if doubtful:
            table = SolidSet(self.robot, solids, np.array(doubtful, dtype=np.int64))
            names = [(solids[i].name, solids[j].name) for i, j in doubtful]
            apart = proven_apart(table, self.robot, names, NEAR_BUDGET)
            pairs = [(i, j) for i, j in pairs if (solids[i].name, solids[j].name) not in apart]
        return SolidSet(self.robot, solids, np.array(pairs, dtype=np.int64).reshape(-1, 2))

    def _check_names(self, scene: Scene) -> None:
        shapes = {solid.name for solid in self._body}
        ours = shapes | {name.partition('/')[0] for name in shapes}
        theirs = {item.name for item in scene.objects} | {item.name for item in scene.attached}
        for name in sorted(theirs & ours):
            raise InvalidInputError(
                f'object {name!r} of the scene has the name of a link of {self.robot.name}'
            )
        for name in sorted({name for pair in scene.may_touch for name in pair} - theirs - ours):
            raise InvalidInputError(
                f'may_touch names {name!r}, which is neither an object of the scene nor a link of '
                f'{self.robot.name}; there are {", ".join(sorted(theirs | ours))}'
            )

    # -- one state -----------------------------------------------------------------------------------

    def in_contact(self, q: ArrayLike) -> bool:
        """Whether anything is in contact at joint positions `q`, (n,) rad (m).

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        return any(self._touches(pair) for pair in self._close(q, 0.0))

    def contacts(self, q: ArrayLike) -> tuple[tuple[str, str], ...]:
        """Names of all bodies that are in contact at joint positions `q`, (n,) rad (m), pair by pair.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        found = {self.names(pair) for pair in self._close(q, 0.0) if self._touches(pair)}
        return tuple(sorted(found))

    def distance(self, q: ArrayLike) -> Proximity | None:
        """The two closest bodies at joint positions `q`, (n,) rad (m); None if there are no pairs.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        self._place(q)
        every = np.arange(self._set.first.size)
        if every.size == 0:
            return None
        for pair in self._with_surface:
            if self._enclosed(int(self._set.first[pair]), int(self._set.second[pair])):
                return self._proximity(int(pair))
        _, closest = self._set.smallest_distance(every, np.inf)
        return self._proximity(closest)

    def distances(self, q: ArrayLike, limit: float) -> tuple[Proximity, ...]:
        """All bodies closer than `limit` (m) to each other at joint positions `q`, the closest first.

        Raises:
            InvalidInputError: `q` of another shape or not finite, or a limit that is not above 0.
        """
        best: dict[tuple[str, str], Proximity] = {}
        for pair in self._close(q, positive(limit, 'limit', 'm')):
            found, names = self._proximity(int(pair)), self.names(pair)
            if found.distance <= limit and (names not in best or found.distance < best[names].distance):
                best[names] = found
        return tuple(sorted(best.values(), key=lambda item: item.distance))

    # -- whole paths ---------------------------------------------------------------------------------

    def closest_approach(self, path: JointPath, *, tolerance: float = 1e-3) -> PathProximity | None:
        """The place of the smallest distance on a path; None if there are no pairs.

        Nothing between the samples is missed: no distance on the path is smaller by more than the tolerance.

        Args:
            path: The motion.
            tolerance: m, above 0.

        Raises:
            InvalidInputError: another number of axes, or a tolerance that is not above 0.
        """
        self._check_path(path)
        if self._set.first.size == 0:
            return None
        time, _ = closest_approach(self._set, path, positive(tolerance, 'tolerance', 'm'))
        return self._at(path, time)

    def first_approach(
        self, path: JointPath, *, margin: float = 0.0, since: float | None = None
    ) -> PathProximity | None:
        """The first place on a path where two bodies are closer than a margin; None if there is none.

        Nothing between the samples is missed, however thin. Bodies that are closer at the start may separate,
        but not approach. Distances within `RESOLUTION` of the margin may count as below it.

        Args:
            path: The motion.
            margin: m, from 0.
            since: Start time, s; the path's start by default.

        Raises:
            InvalidInputError: another number of axes, or a margin that is negative or not finite.
        """
        self._check_path(path)
        since = path.start if since is None else min(max(since, path.start), path.end)
        margins = self._margins(path.sample(since), margin)
        time = first_approach(self._set, path, since, margins)
        return None if time is None else self._at(path, time, margins)

    def certificate(self, start: ArrayLike, *, margin: float = 0.0) -> PathCertificate:
        """Certificates for paths from a posture, with the distances that pairs keep on them.

        `first_approach` finds nothing on a path of pieces that are certified.

        Args:
            start: Joint positions, (n,) rad (m). Bodies that are closer there may separate.
            margin: m, from 0.

        Raises:
            InvalidInputError: `start` of another shape or not finite, or a margin that is negative.
        """
        q = finite_vector(start, self.robot.num_axes, 'start')
        kept = self._margins(q, margin) + RESOLUTION + ROUNDING
        at_start = self._set.distances(np.arange(kept.size), kept)
        # Those that are just above the margin may stay so.
        close = at_start <= kept
        kept[close] = np.maximum(at_start[close] - ROUNDING, 0.0)
        return PathCertificate(self._set.body, self._set.placed, kept, self._work)

    def proximity(self, q: ArrayLike, pair: int) -> Proximity:
        """How close a pair of the certificate is at joint positions `q`, (n,) rad (m)."""
        self._place(q)
        return self._proximity(pair)

    def names(self, pair: int) -> tuple[str, str]:
        """Names of a pair, that moved by more axes first."""
        solids = self._set.solids
        return solids[self._set.second[pair]].name, solids[self._set.first[pair]].name

    def _margins(self, q: Array, margin: float) -> Array:
        """Distances that pairs keep on a path from `q`, (p,) m: those that are closer there may separate."""
        margins = np.full(self._set.first.size, checked_margin(margin))
        self._set.place(q)
        at_start = self._set.distances(np.arange(margins.size), margins)
        leaving = (at_start > 0.0) & (at_start <= margins)
        margins[leaving] = np.maximum(at_start[leaving] - 2.0 * RESOLUTION, 0.0)
        return margins

    def check(self, path: JointPath, *, margin: float = 0.0) -> None:
        """Check that a path keeps the margin everywhere.

        Raises:
            CollisionError: it does not; names the bodies and the place on the path.
            InvalidInputError: see `first_approach`.
        """
        place = self.first_approach(path, margin=margin)
        if place is not None:
            raise CollisionError(place, margin)

    # -- pairs ---------------------------------------------------------------------------------------

    def _check_path(self, path: JointPath) -> None:
        if path.position.shape[1] != self.robot.num_axes:
            raise InvalidInputError(
                f'the path has {path.position.shape[1]} axes, robot {self.robot.name} has '
                f'{self.robot.num_axes}'
            )

    def _at(self, path: JointPath, time: float, margins: Array | None = None) -> PathProximity:
        q = path.sample(time)
        self._place(q)
        if margins is None:
            found = self.distance(q)
            assert found is not None
        else:
            # Of several pairs below their margins, the one farthest below.
            bounds = self._set.distances(np.arange(margins.size), margins + RESOLUTION)
            found = self._proximity(int(np.argmin(bounds - margins)))
        tool0 = self.robot.pose(q)
        return PathProximity(time, path.fraction(time), read_only(q), tool0, found)

    def _place(self, q: ArrayLike) -> None:
        self._set.place(q)
        self._engine.place(self._set.R, self._set.t)

    def _close(self, q: ArrayLike, limit: float) -> Indices:
        """Pairs that may be closer than `limit`, m."""
        self._place(q)
        close: Indices = np.flatnonzero(self._set.broad_distances(limit) <= limit)
        return close

    def _touches(self, pair: int) -> bool:
        i, j = int(self._set.first[pair]), int(self._set.second[pair])
        return self._engine.in_contact(i, j) or self._enclosed(i, j)

    def _enclosed(self, i: int, j: int) -> bool:
        """Whether one solid is inside of the other, a closed surface."""
        for outer, inner in ((i, j), (j, i)):
            if not self._surfaces[outer]:
                continue
            local = self._set.R[outer].T @ (self._set.inside[inner] - self._set.t[outer])
            low, high = self._set.solids[outer].bounds
            if ((local > low) & (local < high)).all() and self._set.solids[outer].encloses(local):
                return True
        return False

    def _proximity(self, pair: int) -> Proximity:
        i, j = int(self._set.first[pair]), int(self._set.second[pair])
        names = self.names(pair)
        if self._enclosed(i, j):
            point = read_only(self._set.t[j])
            return Proximity(*names, 0.0, point, point)
        found = self._set.nearest(pair)
        return Proximity(*names, float(found[1]), read_only(found[5:]), read_only(found[2:5]))


def checked_margin(margin: float) -> float:
    """`margin` if it is a finite number from 0.

    Raises:
        InvalidInputError: negative, NaN or infinite.
    """
    if not 0.0 <= margin < np.inf:
        raise InvalidInputError(f'margin = {margin!r} m must be a finite number from 0')
    return float(margin)
