# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""The pose residual on a path, Newton's method on it, and derivatives of the solution, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from robots_core.blocks.inverse_kinematics.closest_orientation_kernel import correct as correct_held
from robots_core.blocks.inverse_kinematics.closest_orientation_kernel import rate
from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, error_between, jacobian_der, pose_and_jacobian
from robots_core.kernels.vectors import copy_into
from robots_core.validation import Array
from robots_planning.path_kinematics.pseudo_inverse import apply_pseudo_inverse, multiply, pseudo_inverse
from robots_planning.paths.cartesian_path_kernel import PathArrays, pose_on_path

CORRECTION_TOLERANCE = 1e-13  # m and rad; of the axes, that over the smallest singular value
CORRECTION_STEPS = 4
LARGEST_JOINT_STEP = 0.25  # rad (m) of one axis between path samples; more may hide a change of configuration
HELD_TOLERANCE = 1e-12  # m and rad; conditions whose derivatives are differences converge to no less
HELD_STEPS = 6
DIFFERENCE = 1e-5  # of the path, for q''
DERIVATIVE_TOLERANCE = 1e-7  # of |x'|, by which J q' may differ from x', as it does in a singularity


class PoseResidual(NamedTuple):
    """A robot, a target pose on a path, and its residual at joint positions q.

    Attributes:
        chain: Arrays of a `SerialChain`.
        r: Position of the target, (3,).
        T: Its orientation, (3, 3).
        x_s: The path's first derivative over s there, (6,).
        x_ss: Its second derivative, (6,).
        J: Geometric Jacobian at q, (6, n).
        error: The residual: translation and rotation vector from the tool to the target, (6,).
        rows: What of the target is held: 0 for the whole pose, 3 for the position alone, 3 + n for the
            closest orientation too: see `closest_orientation_kernel`.
    """

    chain: ChainArrays
    r: Array
    T: Array
    x_s: Array
    x_ss: Array
    J: Array
    error: Array
    rows: int


@compiled()
def residual_for(chain: ChainArrays, n: int, rows: int) -> PoseResidual:
    """Memory for a robot of n axes, made once per path."""
    r, T, x_s, x_ss = np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6)
    return PoseResidual(chain, r, T, x_s, x_ss, np.empty((6, n)), np.empty(6), rows)


@compiled()
def place_target(residual: PoseResidual, path: PathArrays, s: float) -> None:
    """Set the target to the path's pose at `s`, with its derivatives."""
    pose_on_path(path, s, residual.r, residual.T, residual.x_s, residual.x_ss)


@compiled()
def evaluate_residual(residual: PoseResidual, q: Array) -> float:
    """Fill pose, Jacobian and residual at joint positions `q`, (n,); return the largest |entry|."""
    r, T = np.empty(3), np.empty((3, 3))
    pose_and_jacobian(residual.chain, q, r, T, residual.J)
    error_between(r, T, residual.r, residual.T, residual.error)
    largest = 0.0
    for k in range(6):
        largest = max(largest, abs(residual.error[k]))
    return largest


@compiled()
def correct(residual: PoseResidual, q: Array) -> bool:
    """Newton's method from a close guess `q`, in place; False if it does not converge in a few steps.

    Afterwards the residual is that at the corrected `q`, if the whole pose is held.
    """
    if residual.rows > 0:
        chain, r, T = residual.chain, residual.r, residual.T
        return correct_held(chain, q, r, T, residual.rows, HELD_TOLERANCE, HELD_STEPS, LARGEST_JOINT_STEP)
    error = evaluate_residual(residual, q)
    for _ in range(CORRECTION_STEPS):
        if error < CORRECTION_TOLERANCE:
            break
        step = apply_pseudo_inverse(residual.J, residual.error)
        for k in range(q.size):
            if not abs(step[k]) <= LARGEST_JOINT_STEP:
                return False
        for k in range(q.size):
            q[k] += step[k]
        error = evaluate_residual(residual, q)
    return error < CORRECTION_TOLERANCE


@compiled()
def rates_held(residual: PoseResidual, path: PathArrays, s: float, q: Array, q_s: Array, q_ss: Array) -> bool:
    """Fill q', which keeps what is held of poses at `s`, and q'', its difference along the path."""
    chain, rows = residual.chain, residual.rows
    if not rate(chain, q, residual.r, residual.T, residual.x_s, rows, q_s):
        return False
    r, T, x_s, x_ss = np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6)
    around, fine = np.empty((2, q.size)), True
    for side in range(2):
        shift = (2 * side - 1) * DIFFERENCE
        pose_on_path(path, s + shift, r, T, x_s, x_ss)
        fine = rate(chain, q + shift * q_s, r, T, x_s, rows, around[side]) and fine
    for k in range(q.size):
        q_ss[k] = (around[1, k] - around[0, k]) / (2.0 * DIFFERENCE)
    return fine


@compiled()
def derivatives(
    residual: PoseResidual, desired: Array, desired_s: Array, pull: float, q_s: Array, q_ss: Array
) -> bool:
    """Fill q' and q'', (n,), where the residual is 0; False if J q' misses x'.

    q' = J^+ x', or with redundant axes h + J^+ (x' - J h), where h are the desired rates of the axes, (n,),
    which change with s by `desired_s` and fall with q by `pull`. q'' is the derivative of that (Golub and
    Pereyra 1973).
    """
    n, x_s, J = q_s.size, residual.x_s, residual.J
    P = pseudo_inverse(J) if n > 6 else J
    if n > 6:
        copy_into(q_s, _nearest_solution(J, P, x_s, desired))
    else:
        copy_into(q_s, apply_pseudo_inverse(J, x_s))
    rest = multiply(J, q_s)
    missing, whole = 0.0, 0.0
    for k in range(6):
        missing += (x_s[k] - rest[k]) ** 2
        whole += x_s[k] ** 2
    if not sqrt(missing) <= DERIVATIVE_TOLERANCE * sqrt(whole):
        return False
    J_s = np.empty((6, n))
    jacobian_der(J, q_s, J_s)
    rest = multiply(J_s, q_s)
    for k in range(6):
        rest[k] = residual.x_ss[k] - rest[k]
    if n <= 6:
        copy_into(q_ss, apply_pseudo_inverse(J, rest))
        return True
    # J^+ (x'' - J' q' - J z) + z with z = h' + J'^T J^+T (q' - h)
    free = np.empty(n)
    for k in range(n):
        free[k] = q_s[k] - desired[k]
    free = multiply(J_s.T, multiply(P.T, free))
    for k in range(n):
        free[k] += desired_s[k] - pull * q_s[k]
    copy_into(q_ss, _nearest_solution(J, P, rest, free))
    return True


@compiled()
def _nearest_solution(J: Array, P: Array, b: Array, z: Array) -> Array:
    """The solution y (n,) of J y = b that is nearest to z (n,)."""
    rest = multiply(J, z)
    for k in range(6):
        rest[k] = b[k] - rest[k]
    y = multiply(P, rest)
    for k in range(y.size):
        y[k] += z[k]
    return y
