"""SolidSet: solids of a robot and its surroundings, placed and checked by compiled code."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.collision.distances.nearest_points import Indices, PartArrays
from robots_core.blocks.collision.distances.pair_kernels import (
    broad_distances,
    distances,
    smallest_distance,
    solid_distance,
    travels,
)
from robots_core.blocks.collision.distances.placed_solids import BodyArrays, PlacedArrays, SolidArrays, place
from robots_core.blocks.collision.solids import BOX_CORNERS, Solid
from robots_core.kernels.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector


class SolidSet:
    """Solids fixed to the frames of a robot, and the pairs (p, 2) of them that are to be checked."""

    def __init__(self, robot: BaseRobotModel, solids: Sequence[Solid], pairs: Indices) -> None:
        self.solids = tuple(solids)
        frames = np.array([solid.frame for solid in solids], dtype=np.int64)
        # The solid that is moved by more axes comes second.
        ordered = np.where((frames[pairs[:, 0]] > frames[pairs[:, 1]])[:, None], pairs[:, ::-1], pairs)
        self.first, self.second = (np.ascontiguousarray(ordered[:, column]) for column in (0, 1))
        chain = SerialChain.of(robot)
        arrays = _solid_arrays(self.solids, frames, *_poses_in_chain(robot, chain, self.solids))
        balls, reaches = [solid.ball for solid in solids], [solid.reach for solid in solids]
        centres = np.array([centre for centre, _ in balls]).reshape(-1, 3)
        self.body: BodyArrays = (
            arrays,
            chain.arrays,
            (
                np.array([points for points, _ in reaches]).reshape(-1, *BOX_CORNERS.shape),
                np.array([radius for _, radius in reaches]),
            ),
            (centres, np.array([radius for _, radius in balls])),
            self.first,
            self.second,
        )
        """The solids and the axes for compiled code."""
        count, n = len(solids), robot.num_axes
        self.R, self.t = arrays[7].copy(), arrays[8].copy()
        self.inside = self.t + np.einsum('sij,sj->si', self.R, centres)
        """A point in each solid, (s, 3) m."""
        self.placed: PlacedArrays = (
            np.empty((n, 3)),
            np.empty((n, 3, 3)),
            self.R,
            self.t,
            np.empty((count, n)),
            np.zeros((self.first.size, 3)),
            self.inside,
            np.empty((8, 3)),
            np.empty(8),
        )
        """Scratch memory for compiled code."""

    def place(self, q: ArrayLike) -> None:
        """Place all solids for joint positions `q`, (n,).

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        # Read-only arrays would be compiled for again.
        place(self.body, self.placed, np.array(finite_vector(q, len(self.placed[0]), 'q')))

    def broad_distances(self, enough: float) -> Array:
        """Fast lower bounds of the distances of all pairs, (p,) m, less tight beyond `enough`."""
        return broad_distances(self.body, self.placed, enough)

    def distances(self, chosen: Indices, enough: Array) -> Array:
        """Proven lower bounds of the distances of chosen pairs, (k,) m; exact up to `enough`, (k,)."""
        return distances(self.body, self.placed, chosen, enough)

    def smallest_distance(self, chosen: Indices, limit: float) -> tuple[float, int]:
        """Smallest distance of chosen pairs, m, and which of them; `limit` and -1 if none is below."""
        return smallest_distance(self.body, self.placed, chosen, limit)

    def nearest(self, pair: int) -> Array:
        """Lower bound and distance, m, and nearest points of a pair, (8,); see `nearest_points`."""
        result = np.empty(8)
        i, j = self.first[pair], self.second[pair]
        solid_distance(self.body[0], self.R, self.t, i, j, (0.0, np.inf, False), result)
        return result

    def travels(self, chosen: Indices, turn: Array) -> Array:
        """Bounds on the approach of chosen pairs if the axes move by at most `turn`, (n,) rad (m); (k,) m."""
        return travels(self.body, self.placed, chosen, turn)


def _poses_in_chain(
    robot: BaseRobotModel, chain: SerialChain, solids: Sequence[Solid]
) -> tuple[Array, Array]:
    """Orientations (s, 3, 3) and positions (s, 3) of solids in the frames of the chain.

    They are fixed to the frames of the kinematic model, which may lie elsewhere on the same bodies.
    """
    r, T = robot.kinematic_model.frame_axes(np.zeros(robot.num_axes))
    axes = zip(chain.points, chain.frames, r, T, strict=True)
    moved = [Pose(point, frame).inverse() @ Pose(*own) for point, frame, *own in axes]
    frames = [Pose.identity(), *moved]
    poses = [frames[solid.frame] @ solid.pose for solid in solids]
    orientations = np.array([pose.T for pose in poses]).reshape(-1, 3, 3)
    return orientations, np.array([pose.r for pose in poses]).reshape(-1, 3)


def _solid_arrays(solids: Sequence[Solid], frames: Indices, R: Array, t: Array) -> SolidArrays:
    # Array shapes are stated explicitly, for robots without solids.
    parts = [[solid.core[0]] if solid.convex else list(solid.triangles) for solid in solids]
    vertices, sizes = [part for own in parts for part in own], [len(own) for own in parts]
    balls = [_ball(solid, part) for solid, own in zip(solids, parts, strict=True) for part in own]
    bounds = np.array([solid.bounds for solid in solids]).reshape(-1, 2, 3)
    rounded = np.array([solid.core[1:] for solid in solids]).reshape(-1, 3).repeat(sizes, axis=0)
    disc, half, radius = np.ascontiguousarray(rounded.T)
    part_arrays: PartArrays = (
        np.concatenate([np.empty((0, 3)), *vertices]),
        _offsets([len(part) for part in vertices]),
        disc,
        half,
        radius,
        np.arange(len(solids)).repeat(sizes),
    )
    return (
        part_arrays,
        _offsets(sizes),
        np.array([centre for centre, _ in balls]).reshape(-1, 3),
        np.array([ball for _, ball in balls]),
        0.5 * (bounds[:, 0] + bounds[:, 1]),
        0.5 * (bounds[:, 1] - bounds[:, 0]),
        frames,
        R,
        t,
    )


def _ball(solid: Solid, vertices: Array) -> tuple[Array, float]:
    """A ball around a part of a solid, in the solid's frame."""
    if solid.convex:
        low, high = solid.bounds
        return 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    middle = vertices.mean(axis=0)
    return middle, float(np.linalg.norm(vertices - middle, axis=1).max())


def _offsets(sizes: Sequence[int]) -> Indices:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
