# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Following where the tool holds its position, and of its orientation what the arm can, compiled."""

import numpy as np

from robots_core.blocks.inverse_kinematics.closest_orientation_kernel import correct, rate
from robots_core.kernels.compiled import compiled
from robots_core.validation import Array
from robots_planning.path_kinematics.pose_residual_kernel import LARGEST_JOINT_STEP, PoseResidual
from robots_planning.paths.cartesian_path_kernel import PathArrays, pose_on_path

TOLERANCE = 1e-12  # m and rad; conditions whose derivatives are differences converge to no less
CORRECTION_STEPS = 6
DIFFERENCE = 1e-5  # of the path, for q''


@compiled()
def correct_conditions(residual: PoseResidual, q: Array, rows: int) -> bool:
    """Newton's method on the conditions from a close guess `q`, in place; False if it does not converge."""
    chain, r, T = residual.chain, residual.r, residual.T
    return correct(chain, q, r, T, rows, TOLERANCE, CORRECTION_STEPS, LARGEST_JOINT_STEP)


@compiled()
def rates_held(
    residual: PoseResidual, rows: int, path: PathArrays, s: float, q: Array, q_s: Array, q_ss: Array
) -> bool:
    """Fill q', which keeps the conditions at `s`, and q'', its difference along the path."""
    if not rate(residual.chain, q, residual.r, residual.T, residual.x_s, rows, q_s):
        return False
    r, T, x_s, x_ss = np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6)
    around, fine = np.empty((2, q.size)), True
    for side in range(2):
        shift = (2 * side - 1) * DIFFERENCE
        pose_on_path(path, s + shift, r, T, x_s, x_ss)
        fine = rate(residual.chain, q + shift * q_s, r, T, x_s, rows, around[side]) and fine
    for k in range(q.size):
        q_ss[k] = (around[1, k] - around[0, k]) / (2.0 * DIFFERENCE)
    return fine


@compiled()
def step_held(residual: PoseResidual, q: Array, rows: int) -> Array:
    """The step, (n,), from `q` to where the conditions hold; infinite if that is far."""
    step = q.copy()
    if not correct_conditions(residual, step, rows):
        step[0] = np.inf
    for k in range(q.size):
        step[k] -= q[k]
    return step
