"""SerialChain: a robot's kinematics as a few arrays, for compiled code."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.robot_model.analytic.vectors import (
    add,
    cross,
    product,
    rotation,
    row_of,
    scale,
    subtract,
    times,
)
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

# A product of as many exponentials as a robot has axes is exact to some 1e-15 per metre of reach.
CHAIN_TOLERANCE = 1e-9
PROBES = 4

ChainArrays = tuple[Array, Array, NDArray[np.bool_], Array, Array]
"""Directions, points, prismatic, r and T of a `SerialChain`."""


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
        """The chain of a robot that carries a tool.

        Raises:
            InvalidInputError: the robot's `direct_kinematics` is not that of a chain of single axes.
        """
        n = robot.num_axes
        zero = np.zeros(n)
        r, T = robot.direct_kinematics(zero)
        J = robot.jacobian(zero)
        prismatic = np.array(robot.axes_data.prismatic)
        directions = np.where(prismatic, J[:3], J[3:]).T.copy()
        # A point p turns with v = w x (r - p); the nearest such p to r is r - v x w.
        points = np.where(prismatic[:, None], 0.0, r - np.cross(J[:3].T, J[3:].T))
        flange = Pose(r, T) @ (Pose.identity() if tool is None else tool)
        chain = cls(
            read_only(directions),
            read_only(points),
            prismatic,
            read_only(flange.r),
            read_only(flange.T),
        )
        chain._check(robot, Pose.identity() if tool is None else tool)
        return chain

    @property
    def arrays(self) -> ChainArrays:
        """The attributes as arrays for compiled code."""
        return self.directions, self.points, self.prismatic, self.r, self.T

    def forward(self, q: Array) -> Pose:
        """Pose of the tool centre point at joint positions `q`, (n,)."""
        r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, q.size))
        pose_and_jacobian(self.arrays, np.array(q), r, T, J)  # read-only arrays would be compiled for again
        return Pose(r, T)

    def _check(self, robot: BaseRobotModel, tool: Pose) -> None:
        axes = robot.axes_data
        low, high = axes.one_turn
        for q in np.random.default_rng(0).uniform(low, high, (PROBES, axes.num_axes)):
            expected, found = Pose(*robot.direct_kinematics(q)) @ tool, self.forward(q)
            off = max(np.abs(found.r - expected.r).max(), np.abs(found.T - expected.T).max())
            if not off <= CHAIN_TOLERANCE * (1.0 + np.linalg.norm(expected.r)):
                raise InvalidInputError(
                    f'robot {robot.name!r} is not a chain of axes that turn or slide on their own: its '
                    f'direct kinematics differs from that of its Jacobian at q = 0 by {off:.3g}'
                )


@compiled(nrt=False)
def pose_and_jacobian(chain: ChainArrays, q: Array, r: Array, T: Array, J: Array) -> None:
    """Fill pose r (3,), T (3, 3) and geometric Jacobian J (6, n) of a chain at `q`, base frame."""
    directions, points, prismatic, r0, T0 = chain
    n = q.size
    # R, t: displacement of a body that the axes so far carry.
    R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
    for i in range(n):
        axis = times(R, row_of(directions, i))
        if prismatic[i]:
            J[0, i], J[1, i], J[2, i] = axis
            J[3, i], J[4, i], J[5, i] = 0.0, 0.0, 0.0
            t = add(t, scale(q[i], axis))
            continue
        place = add(times(R, row_of(points, i)), t)
        J[0, i], J[1, i], J[2, i] = place  # replaced by the linear column below
        J[3, i], J[4, i], J[5, i] = axis
        E = rotation(axis, q[i])
        R = product(E, R)
        t = add(place, times(E, subtract(t, place)))
    tip = add(times(R, (r0[0], r0[1], r0[2])), t)
    r[0], r[1], r[2] = tip
    for j in range(3):
        T[0, j], T[1, j], T[2, j] = times(R, (T0[0, j], T0[1, j], T0[2, j]))
    for i in range(n):
        if not prismatic[i]:
            arm = subtract(tip, (J[0, i], J[1, i], J[2, i]))
            J[0, i], J[1, i], J[2, i] = cross((J[3, i], J[4, i], J[5, i]), arm)


@compiled(nrt=False)
def error_between(r: Array, T: Array, r_target: Array, T_target: Array, error: Array) -> None:
    """Fill error (6,): translation (m), then rotation vector (rad), from a pose to a target, base frame."""
    error[0], error[1], error[2] = r_target[0] - r[0], r_target[1] - r[1], r_target[2] - r[2]
    # E = T_target T^T
    E00 = T_target[0, 0] * T[0, 0] + T_target[0, 1] * T[0, 1] + T_target[0, 2] * T[0, 2]
    E01 = T_target[0, 0] * T[1, 0] + T_target[0, 1] * T[1, 1] + T_target[0, 2] * T[1, 2]
    E02 = T_target[0, 0] * T[2, 0] + T_target[0, 1] * T[2, 1] + T_target[0, 2] * T[2, 2]
    E10 = T_target[1, 0] * T[0, 0] + T_target[1, 1] * T[0, 1] + T_target[1, 2] * T[0, 2]
    E11 = T_target[1, 0] * T[1, 0] + T_target[1, 1] * T[1, 1] + T_target[1, 2] * T[1, 2]
    E12 = T_target[1, 0] * T[2, 0] + T_target[1, 1] * T[2, 1] + T_target[1, 2] * T[2, 2]
    E20 = T_target[2, 0] * T[0, 0] + T_target[2, 1] * T[0, 1] + T_target[2, 2] * T[0, 2]
    E21 = T_target[2, 0] * T[1, 0] + T_target[2, 1] * T[1, 1] + T_target[2, 2] * T[1, 2]
    E22 = T_target[2, 0] * T[2, 0] + T_target[2, 1] * T[2, 1] + T_target[2, 2] * T[2, 2]
    x, y, z = E21 - E12, E02 - E20, E10 - E01
    sine = sqrt(x * x + y * y + z * z)  # twice the sine and twice the cosine of the angle
    cosine = E00 + E11 + E22 - 1.0
    if cosine < -1.9 and sine < 0.6:
        # Near half a turn the axis is lost in these differences, not in E + E^T = 2 c I + 2 (1 - c) a a^T.
        angle = atan2(sine, cosine)
        c = 0.5 * cosine
        xx, yy, zz = E00 - c, E11 - c, E22 - c
        if xx >= yy and xx >= zz:
            ax, ay, az = xx, 0.5 * (E01 + E10), 0.5 * (E02 + E20)
            sign = -1.0 if x < 0.0 else 1.0
        elif yy >= zz:
            ax, ay, az = 0.5 * (E01 + E10), yy, 0.5 * (E12 + E21)
            sign = -1.0 if y < 0.0 else 1.0
        else:
            ax, ay, az = 0.5 * (E02 + E20), 0.5 * (E12 + E21), zz
            sign = -1.0 if z < 0.0 else 1.0
        factor = sign * angle / sqrt(ax * ax + ay * ay + az * az)
        error[3], error[4], error[5] = factor * ax, factor * ay, factor * az
        return
    factor = atan2(sine, cosine) / sine if sine > 1e-12 else 0.5
    error[3], error[4], error[5] = factor * x, factor * y, factor * z
