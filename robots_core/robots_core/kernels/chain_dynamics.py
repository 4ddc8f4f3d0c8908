# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""ChainDynamics: a robot's rigid dynamics as a few arrays, for compiled code."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final
from weakref import WeakKeyDictionary

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, SerialChain, next_frame
from robots_core.kernels.vectors import (
    Vector,
    add,
    cross,
    dot,
    matrix_of,
    product,
    row_of,
    scale,
    subtract,
    times,
    transposed,
)
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

# Relative to the torques of the test states; both sides round to some 1e-15 of them.
DYNAMICS_TOLERANCE = 1e-9
PROBES = 6

DynamicsArrays = tuple[ChainArrays, Array, Array, Array, Array]
"""Of a `SerialChain`; masses; centres and inertias in the frames of the axes; gravity."""

NO_DYNAMICS: Final[DynamicsArrays] = (
    np.empty((0, 0)),
    np.empty(0),
    np.empty((0, 3)),
    np.empty((0, 3, 3)),
    np.zeros(3),
)
"""Without bodies, of a robot that is no `ChainDynamics`: compiled functions take the same types for all."""

Bodies = tuple[Array, Array]
"""Scratch memory for the moving bodies: (n, 5, 3) and (n, 3, 3)."""


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
    def of(cls, robot: BaseRobotModel) -> ChainDynamics | None:
        """The dynamics of a robot, made and checked once for each.

        Returns:
            None if its `rigid_dynamics` has terms besides its bodies and gravity.

        Raises:
            InvalidInputError: the robot is no chain, see `SerialChain.of`.
        """
        if robot not in _DYNAMICS:
            _DYNAMICS[robot] = cls._checked(robot)
        return _DYNAMICS[robot]

    @classmethod
    def _checked(cls, robot: BaseRobotModel) -> ChainDynamics | None:
        chain, n = SerialChain.of(robot), robot.num_axes
        model = robot.rigid_dynamics_model
        r, T = robot.kinematic_model.frame_axes(np.zeros(n))
        masses, levers, inertias = model.masses[1:], model.centers_of_mass[1:], model.inertias[1:]
        centers = r + np.einsum('ijk,ik->ij', T, levers)
        turned = T @ inertias @ T.transpose(0, 2, 1)
        found = cls(chain, *(read_only(values) for values in (masses, centers, turned, model.gravity)))
        axes, still = robot.axes_data, np.zeros(n)
        low, high = axes.one_turn
        rng = np.random.default_rng(0)
        for q in rng.uniform(low, high, (PROBES, n)):
            q_dot = rng.uniform(-1.0, 1.0, n) * axes.velocity
            _, M, tau_aux = robot.rigid_dynamics(q, q_dot, still)
            our_M, our_aux = found.mass_matrix_and_bias(q, q_dot)
            for ours, theirs in ((our_M, M), (our_aux, tau_aux)):
                if not np.abs(ours - theirs).max() <= DYNAMICS_TOLERANCE * (1.0 + np.abs(theirs).max()):
                    return None
        return found

    @cached_property
    def arrays(self) -> DynamicsArrays:
        """The attributes as arrays for compiled code."""
        chain = self.chain
        T = chain.frames.transpose(0, 2, 1)
        centers = np.einsum('kij,kj->ki', T, self.centers - chain.points)
        inertias = np.ascontiguousarray(T @ self.inertias @ chain.frames)
        return chain.arrays, np.array(self.masses, order='C'), centers, inertias, np.array(self.gravity)

    def mass_matrix_and_bias(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        """Mass matrix (n, n) and torques of Coriolis, centrifugal and gravitational forces (n,)."""
        M, bias = np.empty((q.size, q.size)), np.empty(q.size)
        mass_matrix_and_bias(self.arrays, q, q_dot, M, bias)
        return M, bias


_DYNAMICS: Final[WeakKeyDictionary[BaseRobotModel, ChainDynamics | None]] = WeakKeyDictionary()


def chain_dynamics_of(robot: BaseRobotModel) -> ChainDynamics:
    """The dynamics of a robot.

    Raises:
        InvalidInputError: the robot's `rigid_dynamics` are not those of its bodies under gravity.
    """
    found = ChainDynamics.of(robot)
    if found is None:
        raise InvalidInputError(
            f'the rigid_dynamics of robot {robot.name!r} are not those of the masses and inertias of its '
            f'rigid_dynamics_model under gravity'
        )
    return found


@compiled()
def mass_matrix_and_bias(dynamics: DynamicsArrays, q: Array, q_dot: Array, M: Array, bias: Array) -> None:
    """Fill M (n, n) and bias (n,): composite bodies and recursive Newton-Euler (Featherstone 2008)."""
    fill_dynamics(dynamics, q, q_dot, bodies_of(q.size), M, bias, np.empty(q.size))


@compiled()
def bodies_of(n: int) -> Bodies:
    """Memory for a robot of n axes, made once per loop."""
    return np.empty((n, 5, 3)), np.empty((n, 3, 3))


@compiled(counted=False)
def fill_dynamics(
    dynamics: DynamicsArrays, q: Array, q_dot: Array, bodies: Bodies, M: Array, bias: Array, weight: Array
) -> None:
    """`mass_matrix_and_bias` without allocation; weight (n,) is the part of the bias due to gravity."""
    bias[:] = 0.0  # the accelerations
    _move_bodies(dynamics, (0.0, 0.0, 0.0), q, q_dot, bias, bodies)
    _collect(dynamics, bodies, M, bias, weight)


@compiled(counted=False)
def fill_torques(
    dynamics: DynamicsArrays, q: Array, q_dot: Array, q_ddot: Array, bodies: Bodies, tau: Array
) -> None:
    """Fill the torques tau (n,) of a motion: recursive Newton-Euler (Featherstone 2008)."""
    chain, gravity = dynamics[0], dynamics[4]
    # Gravity acts like an upward acceleration of the base.
    _move_bodies(dynamics, (-gravity[0], -gravity[1], -gravity[2]), q, q_dot, q_ddot, bodies)
    moving = bodies[0]
    force = moment = (0.0, 0.0, 0.0)
    for j in range(tau.size - 1, -1, -1):
        axis, place = row_of(moving[j], 0), row_of(moving[j], 1)
        force, moment = add(force, row_of(moving[j], 3)), add(moment, row_of(moving[j], 4))
        tau[j] = dot(axis, force if chain[j, 12] != 0.0 else subtract(moment, cross(place, force)))


@compiled(counted=False)
def _move_bodies(
    dynamics: DynamicsArrays, base: Vector, q: Array, q_dot: Array, q_ddot: Array, bodies: Bodies
) -> None:
    """Fill the state and inertial forces of the bodies, from the accelerated base to the tip.

    Per axis: direction, a point on it; its body's centre of mass, force and moment about the origin.
    """
    chain, masses, centers, inertias, _ = dynamics
    moving, tensors = bodies
    R = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    t = omega = alpha = last = (0.0, 0.0, 0.0)
    acceleration = base
    for i in range(q.size):
        place, R, t = next_frame(chain, i, q[i], R, t)
        axis = (R[0][2], R[1][2], R[2][2])
        acceleration = add(acceleration, _at(omega, alpha, subtract(place, last)))
        last = place
        spin, push = scale(q_dot[i], axis), scale(q_ddot[i], axis)
        if chain[i, 12] != 0.0:
            acceleration = add(add(acceleration, push), cross(omega, scale(2.0, spin)))
        else:
            alpha = add(add(alpha, push), cross(omega, spin))
            omega = add(omega, spin)
        com = add(times(R, row_of(centers, i)), t)
        tensor = product(product(R, matrix_of(inertias[i])), transposed(R))
        force = scale(masses[i], add(acceleration, _at(omega, alpha, subtract(com, place))))
        moment = add(times(tensor, alpha), cross(omega, times(tensor, omega)))
        moment = add(moment, cross(com, force))
        for k in range(3):
            moving[i, 0, k], moving[i, 1, k], moving[i, 2, k] = axis[k], place[k], com[k]
            moving[i, 3, k], moving[i, 4, k] = force[k], moment[k]
            for column in range(3):
                tensors[i, k, column] = tensor[k][column]


@compiled(counted=False)
def _collect(dynamics: DynamicsArrays, bodies: Bodies, M: Array, bias: Array, weight: Array) -> None:
    """From the tip to the base: sums of forces, and composite bodies."""
    chain, masses, _, _, gravity = dynamics
    moving, tensors = bodies
    n = bias.size
    fall = (gravity[0], gravity[1], gravity[2])
    mass = 0.0
    com = force = moment = (0.0, 0.0, 0.0)
    # The tensor, which is symmetric.
    xx = xy = xz = yy = yz = zz = 0.0
    for j in range(n - 1, -1, -1):
        axis, place = row_of(moving[j], 0), row_of(moving[j], 1)
        force, moment = add(force, row_of(moving[j], 3)), add(moment, row_of(moving[j], 4))
        total = mass + masses[j]
        if total > 0.0:
            # The common centre, and the tensors by the parallel-axis theorem.
            d = subtract(row_of(moving[j], 2), com)
            reduced = mass * masses[j] / total
            com = add(com, scale(masses[j] / total, d))
            square = reduced * dot(d, d)
            xx += tensors[j, 0, 0] + square - reduced * d[0] * d[0]
            yy += tensors[j, 1, 1] + square - reduced * d[1] * d[1]
            zz += tensors[j, 2, 2] + square - reduced * d[2] * d[2]
            xy += tensors[j, 0, 1] - reduced * d[0] * d[1]
            xz += tensors[j, 0, 2] - reduced * d[0] * d[2]
            yz += tensors[j, 1, 2] - reduced * d[1] * d[2]
        mass = total
        if chain[j, 12] != 0.0:
            bias[j] = dot(axis, force)
            push, twist = scale(mass, axis), (0.0, 0.0, 0.0)
        else:
            bias[j] = dot(axis, subtract(moment, cross(place, force)))
            push = scale(mass, cross(axis, subtract(com, place)))
            twist = times(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)), axis)
        weight[j] = -dot(push, fall)
        bias[j] += weight[j]
        for i in range(j + 1):
            other = row_of(moving[i], 0)
            if chain[i, 12] != 0.0:
                M[i, j] = dot(other, push)
            else:
                arm = subtract(com, row_of(moving[i], 1))
                M[i, j] = dot(other, add(twist, cross(arm, push)))
            M[j, i] = M[i, j]


@compiled()
def _at(omega: Vector, alpha: Vector, arm: Vector) -> Vector:
    """Acceleration of a point of a body relative to another, `arm` away from it."""
    return add(cross(alpha, arm), cross(omega, cross(omega, arm)))
