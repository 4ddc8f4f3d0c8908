"""PathCertificate: proofs that pieces of paths are free, for searches that need thousands of them."""

from math import comb

import numpy as np

from robots_core.blocks.collision.along_paths.certificate_kernel import (
    FREE,
    BallArrays,
    BodyArrays,
    PlacedArrays,
    ReachArrays,
    blocking_pair,
    certify,
    certify_line,
)
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.blocks.collision.solids import BOX_CORNERS
from robots_core.kernels.serial_chain import chain_frames
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class PathCertificate:
    """Certificates of a robot in a scene; `body` and `placed` are what compiled searches call `certify` with.

    An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        solids: Its solids and those around it, with the pairs to keep apart.
    """

    def __init__(self, robot: BaseRobotModel, solids: SolidSet) -> None:
        chain = solids.chain.arrays
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
            np.empty((8, 3)),
            np.empty(8),
        )
        """Scratch memory for compiled code."""
        self.work = np.zeros(1, dtype=np.int64)
        """Number of postures that were checked."""

    def line(self, start: Array, end: Array, margins: Array) -> int:
        """The pair that blocks the straight line between two postures, (n,) each, or FREE.

        Args:
            start: (n,) rad (m).
            end: (n,) rad (m).
            margins: Distance that each pair keeps, (p,) m.
        """
        # Read-only arrays would be compiled for again.
        start, end = np.array(start), np.array(end)
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
        return int(blocking_pair(self.body, self.placed, np.array(q), margins))


def _ball_arrays(solids: SolidSet) -> BallArrays:
    balls = [solid.ball for solid in solids.solids]
    moved = np.flatnonzero(solids.arrays[6] > 0).astype(np.int64)
    centres = np.array([centre for centre, _ in balls]).reshape(-1, 3)
    return moved, centres, np.array([radius for _, radius in balls])


def _reach_arrays(solids: SolidSet) -> ReachArrays:
    reaches = [solid.reach for solid in solids.solids]
    points = np.array([some for some, _ in reaches]).reshape(-1, *BOX_CORNERS.shape)
    return points, np.array([radius for _, radius in reaches])


__all__ = ['FREE', 'PathCertificate']
