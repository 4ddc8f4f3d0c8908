# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Conditions of a tool that holds its position, and of its orientation what the arm can, compiled.

At a position, an arm of n axes moves in n - 3 directions of joint space. Its orientation is the closest one
if no such motion reduces the angle to the target: g = (I - J_v^+ J_v) J_w^T e_w = 0, with the linear and
angular rows of the Jacobian and the rotation vector e_w to the target, whose square has the gradient
-2 J_w^T e_w.
"""

from math import cos, sin, sqrt

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.kernels.small_matrices import damped_gram, solve_lower, solve_transposed
from robots_core.kernels.vectors import Vector, copy_into, cross, scale, subtract, vector_of
from robots_core.validation import Array

STEP = 1e-5  # rad (m) of one axis, for central differences: exact to 1e-10
SINGULAR = 1e-6  # ratio of singular values below which an arm cannot hold what it should
SMALL_ANGLE = 1e-4  # rad, below which the closed form of a coefficient is lost in rounding


@compiled()
def residual(
    chain: ChainArrays, q: Array, r: Array, T: Array, J: Array, error: Array, gradient: Array
) -> bool:
    """Fill Jacobian (6, n), pose error (6,) and g (n,) at `q` for r, T; False where J_v is singular."""
    r_now, T_now = np.empty(3), np.empty((3, 3))
    pose_and_jacobian(chain, q, r_now, T_now, J)
    error_between(r_now, T_now, r, T, error)
    return free_part(J, vector_of(error[3:]), gradient)


@compiled()
def free_part(J: Array, turn: Vector, gradient: Array) -> bool:
    """Fill (I - J_v^+ J_v) J_w^T turn, (n,); False where J_v is singular."""
    n = J.shape[1]
    L, back, size = np.empty((3, 3)), np.zeros(3), 0.0
    damped_gram(J[:3], 0.0, L)
    for i in range(3):
        for k in range(n):
            size += J[i, k] ** 2 / 3.0
    if not L[0, 0] * L[1, 1] * L[2, 2] > SINGULAR * size**1.5:
        return False
    for k in range(n):
        gradient[k] = J[3, k] * turn[0] + J[4, k] * turn[1] + J[5, k] * turn[2]
        for i in range(3):
            back[i] += J[i, k] * gradient[k]
    solve_lower(L, back)
    solve_transposed(L, back)
    for k in range(n):
        gradient[k] -= J[0, k] * back[0] + J[1, k] * back[1] + J[2, k] * back[2]
    return True


@compiled()
def system(
    chain: ChainArrays, q: Array, r: Array, T: Array, A: Array, J: Array, error: Array, gradient: Array
) -> bool:
    """Fill the rows A of the conditions' derivatives over q: J_v, and if it has n more rows those of g.

    Jacobian, error and g at `q` are filled too; False where J_v is singular.
    """
    n = q.size
    if not residual(chain, q, r, T, J, error, gradient):
        return False
    for i in range(3):
        copy_into(A[i], J[i])
    if A.shape[0] == 3:
        return True
    moved, other_J, other_error = q.copy(), np.empty((6, n)), np.empty(6)
    ahead, behind = np.empty(n), np.empty(n)
    for k in range(n):
        moved[k] = q[k] + STEP
        fine = residual(chain, moved, r, T, other_J, other_error, ahead)
        moved[k] = q[k] - STEP
        if not (residual(chain, moved, r, T, other_J, other_error, behind) and fine):
            return False
        moved[k] = q[k]
        for i in range(n):
            A[3 + i, k] = (ahead[i] - behind[i]) / (2.0 * STEP)
    return True


@compiled()
def solve(A: Array, b: Array, x: Array) -> bool:
    """Fill x (n,) with the minimum-norm least-squares solution of A x = b; False if the rank is too low.

    The rank of the conditions is n, or 3 for the position alone.
    """
    U, S, V = np.linalg.svd(A, full_matrices=False)
    rank = 3 if A.shape[0] == 3 else A.shape[1]
    if rank > A.shape[1]:  # fewer than three axes hold no position
        return False
    if not S[rank - 1] > SINGULAR * S[0]:
        return False
    x[:] = 0.0
    for i in range(rank):
        part = 0.0
        for k in range(b.size):
            part += U[k, i] * b[k]
        for k in range(x.size):
            x[k] += part / S[i] * V[i, k]
    return True


@compiled()
def correct(
    chain: ChainArrays,
    q: Array,
    r: Array,
    T: Array,
    rows: int,
    tolerance: float,
    steps: int,
    largest: float,
) -> bool:
    """Newton's method on the conditions from a close guess `q`, in place; False if it does not converge.

    Args:
        chain: Arrays of a `SerialChain`.
        q: (n,).
        r: Position of the target, (3,).
        T: Its orientation, (3, 3).
        rows: 3 for the position alone, 3 + n for the closest orientation too.
        tolerance: m and rad.
        steps: Most steps.
        largest: Longest step of one axis, rad (m).
    """
    n = q.size
    A, b, step = np.empty((rows, n)), np.empty(rows), np.empty(n)
    J, error, gradient = np.empty((6, n)), np.empty(6), np.empty(n)
    for round_ in range(steps + 1):
        if not residual(chain, q, r, T, J, error, gradient):
            return False
        _fill_conditions(b, error, gradient)
        if np.abs(b).max() < tolerance:
            return True
        if round_ == steps or not system(chain, q, r, T, A, J, error, gradient):
            return False
        if not solve(A, b, step) or not np.abs(step).max() <= largest:
            return False
        q += step
    return False


@compiled()
def rate(chain: ChainArrays, q: Array, r: Array, T: Array, x_s: Array, rows: int, q_s: Array) -> bool:
    """Fill q' (n,) with which the conditions continue to hold while the target moves with x' (6,).

    False where the arm cannot hold them.
    """
    n = q.size
    A, b = np.empty((rows, n)), np.empty(rows)
    J, error, gradient = np.empty((6, n)), np.empty(6), np.empty(n)
    if not system(chain, q, r, T, A, J, error, gradient):
        return False
    if rows > 3 and not free_part(J, _error_rate(vector_of(error[3:]), vector_of(x_s[3:])), gradient):
        return False
    _fill_conditions(b, x_s, gradient)
    return solve(A, b, q_s)


@compiled()
def _fill_conditions(b: Array, twist: Array, gradient: Array) -> None:
    """Fill b, (3,) or (3 + n,), with the translation of a twist (6,) and, where there is room, -gradient."""
    copy_into(b, twist[:3])
    for k in range(b.size - 3):
        b[3 + k] = -gradient[k]


@compiled()
def _error_rate(e: Vector, w: Vector) -> Vector:
    """The derivative of the rotation vector e to a target that turns by w, base frame.

    The inverse of the left Jacobian of the rotation group (Chirikjian 2012, 10.86).
    """
    square = e[0] ** 2 + e[1] ** 2 + e[2] ** 2
    angle = sqrt(square)
    factor = 1.0 / 12.0
    if angle > SMALL_ANGLE:
        factor = (1.0 - 0.5 * angle * sin(angle) / (1.0 - cos(angle))) / square
    first = cross(e, w)
    second = cross(e, first)
    return subtract(w, subtract(scale(0.5, first), scale(factor, second)))
