"""SolidSet: solids of a robot and its surroundings, placed and checked by compiled code."""

from collections.abc import Sequence

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import PartArrays
from robots_core.blocks.collision.distances.pair_kernels import (
    Indices,
    MotionArrays,
    SolidArrays,
    broad_distances,
    distances,
    place,
    smallest_distance,
    solid_distance,
    travels,
)
from robots_core.blocks.collision.solids import Solid
from robots_core.kernels.serial_chain import SerialChain
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class SolidSet:
    """Solids fixed to the frames of a robot, and the pairs of them that are to be checked.

    Args:
        robot: The robot.
        solids: The solids.
        pairs: (p, 2) indices of solids.
    """

    def __init__(self, robot: BaseRobotModel, solids: Sequence[Solid], pairs: Indices) -> None:
        self._frame_axes = robot.kinematic_model.frame_axes
        self.solids = tuple(solids)
        frames = np.array([solid.frame for solid in solids], dtype=np.int64)
        # The solid that is moved by more axes comes second.
        ordered = np.where((frames[pairs[:, 0]] > frames[pairs[:, 1]])[:, None], pairs[:, ::-1], pairs)
        self.first, self.second = (np.ascontiguousarray(ordered[:, column]) for column in (0, 1))
        self.arrays = _solid_arrays(self.solids, frames)
        """The solids for compiled code."""
        self.chain = SerialChain.of(robot)
        """The robot's axes."""
        self._motion = _motion_arrays(robot, self.chain)
        self.R, self.t = np.empty((len(solids), 3, 3)), np.empty((len(solids), 3))
        self._r, self._T = np.empty((0, 3)), np.empty((0, 3, 3))

    def place(self, q: Array) -> None:
        """Place all solids for joint positions `q`, (n,)."""
        self._r, self._T = self._frame_axes(q)
        place(self.arrays, self._r, self._T, self.R, self.t)

    def broad_distances(self) -> Array:
        """Fast lower bounds of the distances of all pairs, (p,) m; may be below 0."""
        return broad_distances(self.arrays, self.R, self.t, self.first, self.second)

    def distances(self, chosen: Indices, enough: Array) -> Array:
        """Proven lower bounds of the distances of chosen pairs, (k,) m; exact up to `enough`, (k,)."""
        return distances(self.arrays, self.R, self.t, self.first[chosen], self.second[chosen], enough)

    def smallest_distance(self, chosen: Indices, limit: float) -> tuple[float, int]:
        """Smallest distance of chosen pairs, m, and which of them; `limit` and -1 if none is below."""
        return smallest_distance(self.arrays, self.R, self.t, self.first[chosen], self.second[chosen], limit)

    def nearest(self, pair: int) -> Array:
        """Lower bound and distance, m, and nearest points of a pair, (8,); see `nearest_points`."""
        result = np.empty(8)
        solid_distance(
            self.arrays, self.R, self.t, self.first[pair], self.second[pair], 0.0, np.inf, False, result
        )
        return result

    def travels(self, chosen: Indices, turn: Array) -> Array:
        """Bounds on the approach of chosen pairs if the axes move by at most `turn`, (n,) rad (m); (k,) m."""
        return travels(
            self.arrays,
            self._motion,
            self._r,
            self._T,
            self.R,
            self.t,
            self.first[chosen],
            self.second[chosen],
            turn,
        )


def _solid_arrays(solids: Sequence[Solid], frames: Indices) -> SolidArrays:
    # Array shapes are stated explicitly, for robots without solids.
    vertices: list[Array] = []
    rows: list[tuple[float, float, float, int]] = []
    centres: list[Array] = []
    radii: list[float] = []
    sizes: list[int] = []
    for index, solid in enumerate(solids):
        core, disc, half, radius = solid.core
        if solid.convex:
            low, high = solid.bounds
            corners, balls = [core], [(0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)))]
        else:
            corners = list(solid.triangles)
            balls = [
                (middle, float(np.linalg.norm(triangle - middle, axis=1).max()))
                for triangle, middle in zip(corners, solid.triangles.mean(axis=1), strict=True)
            ]
        vertices += corners
        rows += [(disc, half, radius, index)] * len(corners)
        centres += [centre for centre, _ in balls]
        radii += [ball for _, ball in balls]
        sizes.append(len(corners))
    bounds = np.array([solid.bounds for solid in solids]).reshape(-1, 2, 3)
    parts: PartArrays = (
        np.concatenate([np.empty((0, 3)), *vertices]),
        _offsets([len(corners) for corners in vertices]),
        np.array([row[0] for row in rows]),
        np.array([row[1] for row in rows]),
        np.array([row[2] for row in rows]),
        np.array([row[3] for row in rows], dtype=np.int64),
    )
    return (
        parts,
        _offsets(sizes),
        np.array(centres).reshape(-1, 3),
        np.array(radii),
        0.5 * (bounds[:, 0] + bounds[:, 1]),
        0.5 * (bounds[:, 1] - bounds[:, 0]),
        frames,
        np.array([solid.pose.T for solid in solids]).reshape(-1, 3, 3),
        np.array([solid.pose.r for solid in solids]).reshape(-1, 3),
    )


def _offsets(sizes: Sequence[int]) -> Indices:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)


def _motion_arrays(robot: BaseRobotModel, chain: SerialChain) -> MotionArrays:
    _, T = robot.kinematic_model.frame_axes(np.zeros(robot.num_axes))
    return np.einsum('nji,nj->ni', T, chain.directions), np.array(robot.axes_data.prismatic)
