# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""ZoneClearance: how far the tool or the bodies of a robot are from crossing the border of a zone."""

from collections.abc import Sequence
from math import inf
from typing import Final

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import Indices, support
from robots_core.blocks.collision.distances.placed_solids import SolidArrays, box_reach
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.blocks.collision.solids import Solid
from robots_core.blocks.zones.zone import PlacedBox, Zone
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import Vector, dot, row_of
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Geometry, Sphere
from robots_core.validation import Array

SMALL: Final = Sphere(1e-9)  # stands at the border's place where no distance to it is computed


class ZoneClearance:
    """Clearances of solids from the border of one zone, moved by the axes of a robot.

    A clearance is how far a solid may move, in whatever direction, before it crosses the border; below 0 it
    has, and would have to move so far along one of the region's normals to be back. Distances from walls are
    exact for solids of any kind, those from a box to keep out of are proven (see `nearest_points`). An
    instance keeps scratch memory: use one per thread.
    """

    def __init__(self, robot: BaseRobotModel, zone: Zone, solids: Sequence[Solid]) -> None:
        self.zone = zone
        self._names = [solid.name for solid in solids]
        geometry: Geometry = SMALL
        pose = Pose.identity()
        self._around_box = zone.keep == 'out' and isinstance(zone.region, PlacedBox)
        if isinstance(zone.region, PlacedBox):
            geometry, pose = zone.region.box, zone.region.pose
        count = len(solids)
        pairs = np.stack([np.full(count, count), np.arange(count)], axis=1)
        self._set = SolidSet(robot, (*solids, Solid(zone.name, geometry, 0, pose)), pairs)
        self._every = np.arange(count)
        normals, offsets = zone.walls
        # Inside a region its walls must not be crossed along their normals, outside of it against them.
        sign = 1.0 if zone.keep == 'in' else -1.0
        self._normals, self._offsets = np.ascontiguousarray(sign * normals), sign * offsets

    def place(self, q: Array) -> None:
        """Place the solids for joint positions `q`, (n,)."""
        self._set.place(q)

    def clearances(self, enough: Array) -> Array:
        """Clearances of the solids where they were placed, (s,) m.

        Args:
            enough: Beyond it, (s,) m, a lower bound does.
        """
        if not self._around_box:
            return np.asarray(self._walls(self._every, enough).min(axis=1))
        found = self._set.distances(self._every, np.maximum(enough, 0.0))
        inside = np.flatnonzero(found <= 0.0)
        if inside.size:
            # Out of a box a solid is past one of its faces.
            found[inside] = np.minimum(self._walls(inside, np.full(inside.size, np.inf)).max(axis=1), 0.0)
        return found

    def _walls(self, chosen: Indices, enough: Array) -> Array:
        solids, R, t = self._set.body[0], self._set.R, self._set.t
        return _wall_distances(solids, R, t, chosen, self._normals, self._offsets, enough)

    def closest(self, q: Array, enough: float = np.inf) -> tuple[float, str]:
        """The smallest clearance at joint positions `q`, (n,), m, and whose; see `clearances`."""
        self.place(q)
        clearances = self.clearances(np.full(self._every.size, enough))
        worst = int(clearances.argmin())
        return float(clearances[worst]), self._names[worst]

    def travels(self, turn: Array) -> Array:
        """Bounds on the changes of clearances, (s,) m, if axes move by at most `turn`, (n,) rad (m)."""
        return self._set.travels(self._every, turn)


@compiled(counted=False)
def _reach(solids: SolidArrays, R: Array, t: Array, s: int, axis: Vector) -> float:
    """How far a solid reaches along a unit vector, m; see `box_reach`."""
    parts, farthest = solids[0], -inf
    for p in range(solids[1][s], solids[1][s + 1]):
        point = support(parts, R, t, p, axis[0], axis[1], axis[2])
        farthest = max(farthest, dot(point, axis) + parts[4][p])
    return farthest


@compiled()
def _wall_distances(
    solids: SolidArrays, R: Array, t: Array, chosen: Indices, normals: Array, offsets: Array, enough: Array
) -> Array:
    """Distances of walls from the points of solids that are farthest along their normals, (c, k) m.

    Exact up to `enough`, (c,) m, for solids of any kind, lower bounds beyond it; below 0 where a solid
    crosses one. The solids are placed at R (s, 3, 3) and t (s, 3); the walls have unit normals (k, 3) and
    distances from the origin along them, (k,).
    """
    result = np.empty((chosen.size, offsets.size))
    for i in range(chosen.size):
        for k in range(offsets.size):
            wall = row_of(normals, k)
            result[i, k] = offsets[k] - box_reach(solids, R, t, chosen[i], wall)
            if result[i, k] <= enough[i]:
                result[i, k] = offsets[k] - _reach(solids, R, t, chosen[i], wall)
    return result
