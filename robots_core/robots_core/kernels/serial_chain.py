"""SerialChain: a robot's kinematics as a few arrays, for compiled code."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import atan2, cos, sin, sqrt
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from robots_core.errors import InvalidInputError
from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import (
    Matrix,
    Vector,
    add,
    cross,
    matrix_of,
    product,
    scale,
    subtract,
    times,
    transposed,
)
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

# A product of as many exponentials as a robot has axes is exact to some 1e-15 per metre of reach.
CHAIN_TOLERANCE = 1e-9
PROBES = 4

ChainArrays = Array
"""(n + 1, 13): frames with z along each axis, and of the tool, each in the one before: orientation, row by
row, position, and 1 for an axis that slides."""


@dataclass(frozen=True, eq=False)
class SerialChain:
    """Axes as screws at q = 0, base frame (product of exponentials, Brockett 1984).

    Attributes:
        directions: Unit vectors along the axes, (n, 3).
        points: A point on each axis, (n, 3), m.
        prismatic: (n,) bool: the axis slides.
        r: Position of the tool centre point at q = 0, (3,), m.
        T: Orientation of the tool at q = 0, (3, 3).
    """

    directions: Array
    points: Array
    prismatic: NDArray[np.bool_]
    r: Array
    T: Array

    @classmethod
    def of(cls, robot: BaseRobotModel, tool: Pose | None = None) -> SerialChain:
        """The chain of a robot that carries a tool; one without is made and checked once for each robot.

        Raises:
            InvalidInputError: the robot's `direct_kinematics` is not that of a chain of single axes.
        """
        chain = _CHAINS.get(robot)
        if chain is None:
            chain = cls._at_zero(robot)
            _check(chain, robot)
            _CHAINS[robot] = chain
        if tool is None:
            return chain
        tip = Pose(chain.r, chain.T) @ tool
        return replace(chain, r=read_only(tip.r), T=read_only(tip.T))

    @classmethod
    def _at_zero(cls, robot: BaseRobotModel) -> SerialChain:
        """The chain by the robot's pose and its Jacobian at q = 0."""
        zero, slides = np.zeros(robot.num_axes), np.array(robot.axes_data.prismatic)
        tool0, J = Pose(*robot.direct_kinematics(zero)), robot.jacobian(zero)
        directions = np.where(slides, J[:3], J[3:]).T
        # A point p turns with v = w x (r - p); the nearest such p to r is r - v x w.
        points = np.where(slides[:, None], 0.0, tool0.r - np.cross(J[:3].T, J[3:].T))
        return cls(read_only(directions), read_only(points), slides, read_only(tool0.r), read_only(tool0.T))

    @cached_property
    def frames(self) -> Array:
        """Orientations of frames with z along the axes, (n, 3, 3)."""
        z = self.directions
        x = np.cross(np.eye(3)[np.abs(z).argmin(axis=1)], z)
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        return np.stack([x, np.cross(z, x), z], axis=2)

    @cached_property
    def arrays(self) -> ChainArrays:
        """The axes and the tool for compiled code."""
        T = np.concatenate([np.eye(3)[None], self.frames, self.T[None]])
        r = np.concatenate([np.zeros((1, 3)), self.points, self.r[None]])
        links = np.zeros((len(r) - 1, 13))
        links[:, :9] = (T[:-1].transpose(0, 2, 1) @ T[1:]).reshape(-1, 9)
        links[:, 9:12] = np.einsum('kji,kj->ki', T[:-1], np.diff(r, axis=0))
        links[:-1, 12] = self.prismatic
        return links

    def forward(self, q: Array) -> Pose:
        """Pose of the tool centre point at joint positions `q`, (n,)."""
        r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, q.size))
        pose_and_jacobian(self.arrays, np.array(q), r, T, J)  # read-only arrays would be compiled for again
        return Pose(r, T)


_CHAINS: Final[WeakKeyDictionary[BaseRobotModel, SerialChain]] = WeakKeyDictionary()


def _check(chain: SerialChain, robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    low, high = axes.one_turn
    for q in np.random.default_rng(0).uniform(low, high, (PROBES, axes.num_axes)):
        expected, found = Pose(*robot.direct_kinematics(q)), chain.forward(q)
        off = max(np.abs(found.r - expected.r).max(), np.abs(found.T - expected.T).max())
        if not off <= CHAIN_TOLERANCE * (1.0 + np.linalg.norm(expected.r)):
            raise InvalidInputError(
                f'robot {robot.name!r} is not a chain of axes that turn or slide on their own: its '
                f'direct kinematics differs from that of its Jacobian at q = 0 by {off:.3g}'
            )


@compiled()
def next_frame(chain: ChainArrays, i: int, q: float, R: Matrix, t: Vector) -> tuple[Vector, Matrix, Vector]:
    """Where axis i is, (3,), and the frame that it moves, from the frame R, t of the axis before."""
    turn = (
        (chain[i, 0], chain[i, 1], chain[i, 2]),
        (chain[i, 3], chain[i, 4], chain[i, 5]),
        (chain[i, 6], chain[i, 7], chain[i, 8]),
    )
    place = add(t, times(R, (chain[i, 9], chain[i, 10], chain[i, 11])))
    (a, b, x), (d, e, y), (g, h, z) = product(R, turn)
    if chain[i, 12] != 0.0:
        return place, ((a, b, x), (d, e, y), (g, h, z)), add(place, scale(q, (x, y, z)))
    c, s = cos(q), sin(q)
    turned = (
        (c * a + s * b, c * b - s * a, x),
        (c * d + s * e, c * e - s * d, y),
        (c * g + s * h, c * h - s * g, z),
    )
    return place, turned, place


@compiled()
def pose_and_jacobian(chain: ChainArrays, q: Array, r: Array, T: Array, J: Array) -> None:
    """Fill pose r (3,), T (3, 3) and geometric Jacobian J (6, n) of a chain at `q`, base frame."""
    n = q.size
    R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
    for i in range(n):
        place, R, t = next_frame(chain, i, q[i], R, t)
        J[0, i], J[1, i], J[2, i] = place  # replaced below
        J[3, i], J[4, i], J[5, i] = R[0][2], R[1][2], R[2][2]
    tip, R, _ = next_frame(chain, n, 0.0, R, t)
    r[0], r[1], r[2] = tip
    for row in range(3):
        T[row, 0], T[row, 1], T[row, 2] = R[row]
    for i in range(n):
        axis = (J[3, i], J[4, i], J[5, i])
        if chain[i, 12] != 0.0:
            J[0, i], J[1, i], J[2, i] = axis
            J[3, i], J[4, i], J[5, i] = 0.0, 0.0, 0.0
        else:
            J[0, i], J[1, i], J[2, i] = cross(axis, subtract(tip, (J[0, i], J[1, i], J[2, i])))


@compiled()
def tool_poses(chain: ChainArrays, q: Array, r: Array, T: Array) -> bool:
    """Fill positions r (m, 3) and orientations T (m, 3, 3) at finite q (m, n); False for another q.

    Pinocchio's call for each takes six times as long.
    """
    n = q.shape[1]
    if n != chain.shape[0] - 1:
        return False
    total = 0.0
    for k in range(q.shape[0]):
        R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
        for i in range(n):
            total += q[k, i]
            _, R, t = next_frame(chain, i, q[k, i], R, t)
        tip, R, _ = next_frame(chain, n, 0.0, R, t)
        r[k, 0], r[k, 1], r[k, 2] = tip
        for row in range(3):
            T[k, row, 0], T[k, row, 1], T[k, row, 2] = R[row]
    return total - total == 0.0


@compiled()
def error_between(r: Array, T: Array, r_target: Array, T_target: Array, error: Array) -> None:
    """Fill error (6,): translation (m), then rotation vector (rad), from a pose to a target, base frame."""
    error[0], error[1], error[2] = r_target[0] - r[0], r_target[1] - r[1], r_target[2] - r[2]
    # E = T_target T^T
    (E00, E01, E02), (E10, E11, E12), (E20, E21, E22) = product(matrix_of(T_target), transposed(matrix_of(T)))
    x, y, z = E21 - E12, E02 - E20, E10 - E01
    sine = sqrt(x * x + y * y + z * z)  # twice the sine and twice the cosine of the angle
    cosine = E00 + E11 + E22 - 1.0
    if cosine < -1.9 and sine < 0.6:
        # Near half a turn the axis is lost in these differences, not in E + E^T = 2 c I + 2 (1 - c) a a^T.
        angle = atan2(sine, cosine)
        c = 0.5 * cosine
        xx, yy, zz = E00 - c, E11 - c, E22 - c
        xy, xz, yz = 0.5 * (E01 + E10), 0.5 * (E02 + E20), 0.5 * (E12 + E21)
        if xx >= yy and xx >= zz:
            ax, ay, az, along = xx, xy, xz, x
        elif yy >= zz:
            ax, ay, az, along = xy, yy, yz, y
        else:
            ax, ay, az, along = xz, yz, zz, z
        sign = -1.0 if along < 0.0 else 1.0
        factor = sign * angle / sqrt(ax * ax + ay * ay + az * az)
        error[3], error[4], error[5] = factor * ax, factor * ay, factor * az
        return
    factor = atan2(sine, cosine) / sine if sine > 1e-12 else 0.5
    error[3], error[4], error[5] = factor * x, factor * y, factor * z


@compiled()
def jacobian_der(J: Array, q_dot: Array, J_der: Array) -> None:
    """Fill the derivative J_der (6, n) of a geometric Jacobian J (6, n) for joint velocities `q_dot` (n,).

    It follows from the Jacobian alone (Bruyninckx and De Schutter 1996): with w the angular and v the
    linear rows, column i changes with axis j by w_j x v_i if j <= i, and by w_i x v_j if j > i; its angular
    part by w_j x w_i if j < i. An axis that slides has w = 0.
    """
    n = q_dot.size
    # Linear velocity of the tool due to the axes after i, and angular velocity due to those before i.
    after = before = (0.0, 0.0, 0.0)
    for j in range(n):
        after = add(after, scale(q_dot[j], (J[0, j], J[1, j], J[2, j])))
    for i in range(n):
        v, w = (J[0, i], J[1, i], J[2, i]), (J[3, i], J[4, i], J[5, i])
        after = subtract(after, scale(q_dot[i], v))
        J_der[3, i], J_der[4, i], J_der[5, i] = cross(before, w)
        before = add(before, scale(q_dot[i], w))
        J_der[0, i], J_der[1, i], J_der[2, i] = add(cross(before, v), cross(w, after))
