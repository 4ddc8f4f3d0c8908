# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""The pose residual on a path, Newton's method on it, and derivatives of the solution, compiled."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.jacobian_derivative import jacobian_der
from robots_core.kernels.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.validation import Array
from robots_planning.path_kinematics.pseudo_inverse import (
    Scratch,
    apply_pseudo_inverse,
    multiply,
    multiply_transposed,
    pseudo_inverse,
    scratch_for,
)
from robots_planning.paths.cartesian_path_kernel import PathArrays, pose_on_path

CORRECTION_TOLERANCE = 1e-13  # m and rad; of the axes, that over the smallest singular value
CORRECTION_STEPS = 4
LARGEST_JOINT_STEP = 0.25  # rad (m) of one axis between path samples; more may hide a change of configuration
DERIVATIVE_TOLERANCE = 1e-7  # of |x'|, by which J q' may differ from x', as it does in a singularity


class PoseResidual(NamedTuple):
    """A target pose on a path, the tool's pose at joint positions q, and their residual, with scratch memory.

    Attributes:
        r: Position of the target, (3,).
        T: Its orientation, (3, 3).
        x_s: The path's first derivative over s there, (6,).
        x_ss: Its second derivative, (6,).
        r_now: Position of the tool at q, (3,).
        T_now: Its orientation, (3, 3).
        J: Geometric Jacobian at q, (6, n).
        error: The residual: translation and rotation vector from the tool to the target, (6,).
        J_s: Scratch, (6, n).
        P: Scratch, (n, 6).
        desired: Rates of the axes that self-motion comes as close to as it can, (n,); 0 by default.
        desired_s: Their derivative over s at a fixed q, (n,); 0 by default.
        step: Scratch, (n,).
        rest: Scratch, (6,).
        twist: Scratch, (6,).
        solver: Scratch for decompositions.
    """

    r: Array
    T: Array
    x_s: Array
    x_ss: Array
    r_now: Array
    T_now: Array
    J: Array
    error: Array
    J_s: Array
    P: Array
    desired: Array
    desired_s: Array
    step: Array
    rest: Array
    twist: Array
    solver: Scratch


@compiled()
def residual_for(n: int) -> PoseResidual:
    """Memory for a robot of n axes, made once per path."""
    return PoseResidual(
        np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6), np.empty(3), np.empty((3, 3)),
        np.empty((6, n)), np.empty(6), np.empty((6, n)), np.empty((n, 6)), np.zeros(n), np.zeros(n),
        np.empty(n), np.empty(6), np.empty(6), scratch_for(n),
    )  # fmt: skip


@compiled()
def set_target(path: PathArrays, s: float, residual: PoseResidual) -> None:
    """Set the target to the path's pose at `s`, with its derivatives."""
    pose_on_path(path, s, residual.r, residual.T, residual.x_s, residual.x_ss)


@compiled()
def evaluate_residual(chain: ChainArrays, q: Array, residual: PoseResidual) -> float:
    """Fill pose, Jacobian and residual at joint positions `q`, (n,); return the largest |entry|."""
    pose_and_jacobian(chain, q, residual.r_now, residual.T_now, residual.J)
    error_between(residual.r_now, residual.T_now, residual.r, residual.T, residual.error)
    largest = 0.0
    for k in range(6):
        largest = max(largest, abs(residual.error[k]))
    return largest


@compiled()
def correct(chain: ChainArrays, q: Array, residual: PoseResidual) -> bool:
    """Newton's method from a close guess `q`, in place; False if it does not converge in a few steps.

    Afterwards the residual is that at the corrected `q`.
    """
    error = evaluate_residual(chain, q, residual)
    for _ in range(CORRECTION_STEPS):
        if error < CORRECTION_TOLERANCE:
            break
        apply_pseudo_inverse(residual.J, residual.error, residual.step, residual.solver)
        for k in range(q.size):
            if not abs(residual.step[k]) <= LARGEST_JOINT_STEP:
                return False
        for k in range(q.size):
            q[k] += residual.step[k]
        error = evaluate_residual(chain, q, residual)
    return error < CORRECTION_TOLERANCE


@compiled()
def derivatives(residual: PoseResidual, pull: float, q_s: Array, q_ss: Array) -> bool:
    """Fill q' and q'', (n,), where the residual is 0; False if J q' misses x'.

    q' = J^+ x', or with redundant axes h + J^+ (x' - J h), where h are the desired rates, which fall with q
    by `pull`. q'' is the derivative of that (Golub and Pereyra 1973).
    """
    n = q_s.size
    x_s, J, P, J_s, rest = residual.x_s, residual.J, residual.P, residual.J_s, residual.rest
    if n > 6:
        pseudo_inverse(J, P, residual.solver)
        _nearest_solution(J, P, x_s, residual.desired, q_s, rest)
    else:
        apply_pseudo_inverse(J, x_s, q_s, residual.solver)
    multiply(J, q_s, rest)
    missing, whole = 0.0, 0.0
    for k in range(6):
        missing += (x_s[k] - rest[k]) ** 2
        whole += x_s[k] ** 2
    if not sqrt(missing) <= DERIVATIVE_TOLERANCE * sqrt(whole):
        return False
    jacobian_der(J, q_s, J_s)
    multiply(J_s, q_s, rest)
    for k in range(6):
        rest[k] = residual.x_ss[k] - rest[k]
    if n <= 6:
        apply_pseudo_inverse(J, rest, q_ss, residual.solver)
        return True
    # J^+ (x'' - J' q' - J z) + z with z = h' + J'^T J^+T (q' - h)
    free, twist = residual.step, residual.twist
    for k in range(n):
        free[k] = q_s[k] - residual.desired[k]
    multiply_transposed(P, free, twist)
    multiply_transposed(J_s, twist, free)
    for k in range(n):
        free[k] += residual.desired_s[k] - pull * q_s[k]
    _nearest_solution(J, P, rest, free, q_ss, twist)
    return True


@compiled()
def _nearest_solution(J: Array, P: Array, b: Array, z: Array, y: Array, rest: Array) -> None:
    """Fill y (n,) with the solution of J y = b that is nearest to z (n,); `rest` (6,) is scratch."""
    multiply(J, z, rest)
    for k in range(6):
        rest[k] = b[k] - rest[k]
    multiply(P, rest, y)
    for k in range(y.size):
        y[k] += z[k]
