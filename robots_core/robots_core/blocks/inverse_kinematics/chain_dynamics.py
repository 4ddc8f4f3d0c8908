# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""ChainDynamics: a robot's rigid dynamics as a few arrays, for compiled code."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.inverse_kinematics.chain import SerialChain
from robots_core.errors import InvalidInputError
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

# Relative to the torques of the test states; both sides round to some 1e-15 of them.
DYNAMICS_TOLERANCE = 1e-9
PROBES = 6

DynamicsArrays = tuple[Array, Array, NDArray[np.bool_], Array, Array, Array, Array]
"""Directions, points and prismatic of a `SerialChain`; masses, centres, inertias and gravity."""


@dataclass(frozen=True, eq=False)
class ChainDynamics:
    """Bodies behind the axes at q = 0, base frame.

    Attributes:
        chain: The axes.
        masses: (n,) kg.
        centers: Centres of mass, (n, 3), m.
        inertias: About the centres of mass, (n, 3, 3), kg m^2.
        gravity: Acceleration of free fall, (3,), m/s^2.
    """

    chain: SerialChain
    masses: Array
    centers: Array
    inertias: Array
    gravity: Array

    @classmethod
    def of(cls, robot: BaseRobotModel, chain: SerialChain) -> ChainDynamics | None:
        """The dynamics of a robot; None if its `rigid_dynamics` knows of more than its bodies and gravity."""
        n = robot.num_axes
        model = robot.rigid_dynamics_model
        r, T = robot.kinematic_model.frame_axes(np.zeros(n))
        masses, levers, inertias = model.masses[1:], model.centers_of_mass[1:], model.inertias[1:]
        centers = r + np.einsum('ijk,ik->ij', T, levers)
        turned = T @ inertias @ T.transpose(0, 2, 1)
        # Torques at rest are linear in gravity: as many states as needed give it back.
        axes = robot.axes_data
        low = np.where(axes.continuous, -np.pi, axes.lower)
        high = np.where(axes.continuous, np.pi, axes.upper)
        states = np.random.default_rng(0).uniform(low, high, (PROBES, n))
        still = np.zeros(n)
        columns, wanted = [], []
        for q in states:
            per_unit = [
                cls(chain, masses, centers, turned, unit).mass_matrix_and_bias(q, still)[1]
                for unit in np.eye(3)
            ]
            columns.append(np.column_stack(per_unit))
            wanted.append(robot.rigid_dynamics(q, still, still)[2])
        gravity = np.linalg.lstsq(np.vstack(columns), np.concatenate(wanted), rcond=1e-9)[0]
        found = cls(chain, *(read_only(values) for values in (masses, centers, turned, gravity)))
        rng = np.random.default_rng(1)
        for q in states:
            q_dot = rng.uniform(-1.0, 1.0, n) * axes.velocity
            _, M, tau_aux = robot.rigid_dynamics(q, q_dot, still)
            our_M, our_aux = found.mass_matrix_and_bias(q, q_dot)
            for ours, theirs in ((our_M, M), (our_aux, tau_aux)):
                if not np.abs(ours - theirs).max() <= DYNAMICS_TOLERANCE * (1.0 + np.abs(theirs).max()):
                    return None
        return found

    def weight(self, q: Array, gravity: Array) -> Array:
        """Torques (n,) that hold the bodies at `q` against an acceleration of free fall, (3,) m/s^2."""
        M, bias = np.empty((q.size, q.size)), np.empty(q.size)
        arrays = (*self.arrays[:-1], np.array(gravity))
        mass_matrix_and_bias(arrays, np.array(q), np.zeros(q.size), M, bias)
        return bias

    @property
    def arrays(self) -> DynamicsArrays:
        """All of it, as compiled code takes it."""
        chain = self.chain
        return (
            chain.directions,
            chain.points,
            chain.prismatic,
            np.array(self.masses, order='C'),
            np.array(self.centers, order='C'),
            np.array(self.inertias, order='C'),
            np.array(self.gravity),
        )

    def mass_matrix_and_bias(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        """Mass matrix (n, n) and torques of Coriolis, centrifugal and gravitational forces (n,)."""
        M, bias = np.empty((q.size, q.size)), np.empty(q.size)
        mass_matrix_and_bias(self.arrays, q, q_dot, M, bias)
        return M, bias


def chain_dynamics_of(robot: BaseRobotModel) -> ChainDynamics:
    """The dynamics of a robot.

    Raises:
        InvalidInputError: the robot's `rigid_dynamics` are not those of its bodies under gravity.
    """
    found = ChainDynamics.of(robot, SerialChain.of(robot))
    if found is None:
        raise InvalidInputError(
            f'the rigid_dynamics of robot {robot.name!r} are not those of the masses and inertias of its '
            f'rigid_dynamics_model under gravity'
        )
    return found


# Vectors are tuples of three and matrices of three rows: compiled, they are registers and not memory.
Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]


@compiled()
def mass_matrix_and_bias(dynamics: DynamicsArrays, q: Array, q_dot: Array, M: Array, bias: Array) -> None:
    """Fill M (n, n) and bias (n,): composite bodies and recursive Newton-Euler (Featherstone 2008)."""
    directions, points, prismatic, masses, centers, inertias, gravity = dynamics
    n = q.size
    # Per axis: direction, a point on it; its body's centre of mass, force and moment about the origin.
    moving = np.empty((n, 5, 3))
    tensors = np.empty((n, 3, 3))
    R = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    t = omega = alpha = last = (0.0, 0.0, 0.0)
    acceleration = (-gravity[0], -gravity[1], -gravity[2])
    for i in range(n):
        axis, place = _times(R, _vector(directions, i)), _sum(_times(R, _vector(points, i)), t)
        acceleration = _sum(acceleration, _at(omega, alpha, _difference(place, last)))
        last = place
        spin = _scaled(q_dot[i], axis)
        if prismatic[i]:
            t = _sum(t, _scaled(q[i], axis))
            acceleration = _sum(acceleration, _cross(omega, _scaled(2.0, spin)))
        else:
            alpha = _sum(alpha, _cross(omega, spin))
            omega = _sum(omega, spin)
            E = _rotation(axis, q[i])
            t = _sum(place, _times(E, _difference(t, place)))
            R = _product(E, R)
        com = _sum(_times(R, _vector(centers, i)), t)
        tensor = _turned(R, inertias, i)
        force = _scaled(masses[i], _sum(acceleration, _at(omega, alpha, _difference(com, place))))
        moment = _sum(_times(tensor, alpha), _cross(omega, _times(tensor, omega)))
        moment = _sum(moment, _cross(com, force))
        for k in range(3):
            moving[i, 0, k], moving[i, 1, k], moving[i, 2, k] = axis[k], place[k], com[k]
            moving[i, 3, k], moving[i, 4, k] = force[k], moment[k]
            for column in range(3):
                tensors[i, k, column] = tensor[k][column]
    _collect(moving, tensors, prismatic, masses, M, bias)


@compiled()
def _collect(
    moving: Array, tensors: Array, prismatic: NDArray[np.bool_], masses: Array, M: Array, bias: Array
) -> None:
    """From the tip to the base: sums of forces, and bodies that become one."""
    n = bias.size
    mass = 0.0
    com = force = moment = (0.0, 0.0, 0.0)
    tensor = np.zeros((3, 3))
    for j in range(n - 1, -1, -1):
        axis, place = _vector(moving[j], 0), _vector(moving[j], 1)
        force, moment = _sum(force, _vector(moving[j], 3)), _sum(moment, _vector(moving[j], 4))
        total = mass + masses[j]
        if total > 0.0:
            # The common centre, and the tensors by the parallel-axis theorem.
            d = _difference(_vector(moving[j], 2), com)
            reduced = mass * masses[j] / total
            com = _sum(com, _scaled(masses[j] / total, d))
            square = reduced * _dot(d, d)
            for row in range(3):
                for column in range(3):
                    tensor[row, column] += tensors[j, row, column] - reduced * d[row] * d[column]
                tensor[row, row] += square
        mass = total
        if prismatic[j]:
            bias[j] = _dot(axis, force)
            push, twist = _scaled(mass, axis), (0.0, 0.0, 0.0)
        else:
            bias[j] = _dot(axis, _difference(moment, _cross(place, force)))
            push = _scaled(mass, _cross(axis, _difference(com, place)))
            rows = (_vector(tensor, 0), _vector(tensor, 1), _vector(tensor, 2))
            twist = _times(rows, axis)
        for i in range(j + 1):
            other = _vector(moving[i], 0)
            if prismatic[i]:
                M[i, j] = _dot(other, push)
            else:
                arm = _difference(com, _vector(moving[i], 1))
                M[i, j] = _dot(other, _sum(twist, _cross(arm, push)))
            M[j, i] = M[i, j]


@compiled()
def _vector(rows: Array, i: int) -> Vector:
    return rows[i, 0], rows[i, 1], rows[i, 2]


@compiled()
def _at(omega: Vector, alpha: Vector, arm: Vector) -> Vector:
    """Acceleration of a point of a body relative to another, `arm` away from it."""
    return _sum(_cross(alpha, arm), _cross(omega, _cross(omega, arm)))


@compiled()
def _sum(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled()
def _difference(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled()
def _scaled(factor: float, a: Vector) -> Vector:
    return factor * a[0], factor * a[1], factor * a[2]


@compiled()
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled()
def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled()
def _times(A: Matrix, v: Vector) -> Vector:
    return _dot(A[0], v), _dot(A[1], v), _dot(A[2], v)


@compiled()
def _product(A: Matrix, B: Matrix) -> Matrix:
    x, y, z = (B[0][0], B[1][0], B[2][0]), (B[0][1], B[1][1], B[2][1]), (B[0][2], B[1][2], B[2][2])
    return (
        (_dot(A[0], x), _dot(A[0], y), _dot(A[0], z)),
        (_dot(A[1], x), _dot(A[1], y), _dot(A[1], z)),
        (_dot(A[2], x), _dot(A[2], y), _dot(A[2], z)),
    )


@compiled()
def _turned(R: Matrix, tensors: Array, i: int) -> Matrix:
    """R I R^T of tensor i."""
    tensor = (_vector(tensors[i], 0), _vector(tensors[i], 1), _vector(tensors[i], 2))
    half = _product(R, tensor)
    return _times(R, half[0]), _times(R, half[1]), _times(R, half[2])


@compiled()
def _rotation(axis: Vector, angle: float) -> Matrix:
    """Rodrigues' formula."""
    x, y, z = axis
    c, s = cos(angle), sin(angle)
    v = 1.0 - c
    return (
        (c + v * x * x, v * x * y - s * z, v * x * z + s * y),
        (v * x * y + s * z, c + v * y * y, v * y * z - s * x),
        (v * x * z - s * y, v * y * z + s * x, c + v * z * z),
    )
