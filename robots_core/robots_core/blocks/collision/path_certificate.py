"""PathCertificate: proofs that pieces of paths are free, for searches that need thousands of them."""

from math import comb

import numpy as np

from robots_core.blocks.collision.certificate_kernel import (
    FREE,
    BallArrays,
    BodyArrays,
    PlacedArrays,
    ReachArrays,
    blocking_pair,
    certify,
    certify_line,
)
from robots_core.blocks.collision.solid_set import SolidSet
from robots_core.kernels.serial_chain import SerialChain, chain_frames
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
FEW_POINTS = 8  # of a hull, up to which its own points are used in place of its box's corners


class PathCertificate:
    """Certificates of a robot in a scene; `body` and `placed` are what compiled searches call `certify` with.

    An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        solids: Its solids and those around it, with the pairs to keep apart.
    """

    def __init__(self, robot: BaseRobotModel, solids: SolidSet) -> None:
        chain = SerialChain.of(robot).arrays
        # The solids are fixed to the frames of the kinematic model: here, to those of the chain.
        r, T = robot.kinematic_model.frame_axes(np.zeros(robot.num_axes))
        r_chain, T_chain = chain_frames(chain)
        frames = solids.arrays[6]
        local_R, local_t = solids.arrays[7].copy(), solids.arrays[8].copy()
        for s, frame in enumerate(frames):
            if frame > 0:
                at, turn = r[frame - 1], T[frame - 1]
                back = T_chain[frame - 1].T
                local_t[s] = back @ (at + turn @ local_t[s] - r_chain[frame - 1])
                local_R[s] = back @ turn @ local_R[s]
        balls = _ball_arrays(solids)
        self.body: BodyArrays = (
            (*solids.arrays[:7], local_R, local_t),
            chain,
            _reach_arrays(solids),
            balls,
            solids.first,
            solids.second,
        )
        """The robot and its scene for compiled code."""
        count, n = frames.size, robot.num_axes
        self.placed: PlacedArrays = (
            np.empty((n, 3)),
            np.empty((n, 3, 3)),
            local_R.copy(),
            local_t.copy(),
            np.empty((count, n)),
            np.zeros((solids.first.size, 3)),
            local_t + np.einsum('sij,sj->si', local_R, balls[1]),
        )
        """Scratch memory for compiled code."""
        self.work = np.zeros(1, dtype=np.int64)
        """Number of postures that were looked at."""

    def line(self, start: Array, end: Array, margins: Array) -> int:
        """The pair that blocks the straight line between two postures, (n,) each, or FREE.

        Args:
            start: (n,) rad (m).
            end: (n,) rad (m).
            margins: Distance that each pair keeps, (p,) m.
        """
        return int(certify_line(self.body, self.placed, start, end, margins, self.work)[0])

    def piece(self, coefficients: Array, margins: Array) -> int:
        """The pair that blocks a polynomial over [0, 1], or FREE.

        Args:
            coefficients: In powers of s, (m, n).
            margins: Distance that each pair keeps, (p,) m.
        """
        # The derivative lies in the hull of its control points (Bernstein form).
        degree = len(coefficients) - 2
        slopes = np.arange(1, degree + 2)[:, None] * coefficients[1:]
        control = [
            sum(comb(j, k) / comb(degree, k) * slopes[k] for k in range(j + 1)) for j in range(degree + 1)
        ]
        speed = np.abs(control).max(axis=0)
        return int(certify(self.body, self.placed, coefficients, speed, margins, self.work)[0])

    def posture(self, q: Array, margins: Array) -> int:
        """A pair that is closer than its margin at joint positions `q`, (n,), or FREE."""
        return int(blocking_pair(self.body, self.placed, q, margins))


def _ball_arrays(solids: SolidSet) -> BallArrays:
    centres: list[Array] = []
    radii: list[float] = []
    for solid in solids.solids:
        core, disc, half, radius = solid.core
        # A surface holds its points; a hull also their mean.
        centre = np.zeros(3) if disc > 0.0 else core.mean(axis=0) if solid.convex else core[0]
        farthest = np.hypot(disc, half) if disc > 0.0 else np.linalg.norm(core - centre, axis=1).max()
        centres.append(centre)
        radii.append(float(farthest) + radius)
    moved = np.flatnonzero(solids.arrays[6] > 0).astype(np.int64)
    return moved, np.array(centres).reshape(-1, 3), np.array(radii)


def _reach_arrays(solids: SolidSet) -> ReachArrays:
    points: list[Array] = []
    radii: list[float] = []
    centres, halves = solids.arrays[4], solids.arrays[5]
    for solid, centre, half in zip(solids.solids, centres, halves, strict=True):
        core, disc, _, radius = solid.core
        few = solid.convex and disc == 0.0 and len(core) <= FEW_POINTS
        points.append(np.asarray(core) if few else centre + CORNERS * half)
        radii.append(radius if few else 0.0)
    first = np.cumsum([0, *(len(some) for some in points)]).astype(np.int64)
    return np.concatenate([np.empty((0, 3)), *points]), first, np.array(radii)


__all__ = ['FREE', 'PathCertificate']
