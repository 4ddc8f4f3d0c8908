# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""A path followed by a redundant robot, compiled: q' = J^+ x' with self-motion towards a guide."""

import numpy as np

from robots_core.blocks.inverse_kinematics.jacobian_derivative import jacobian_der
from robots_core.blocks.inverse_kinematics.serial_chain import ChainArrays
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import (
    FOLLOWED,
    PATH_TOLERANCE,
    SHORTEST_STEP,
    SINGULAR_START,
    TOO_FAR,
    JointSamples,
    extrapolate,
    integrate,
    interpolate,
    judge,
    next_break,
    next_step,
)
from robots_planning.path_kinematics.pose_residual_kernel import (
    DERIVATIVE_TOLERANCE,
    LARGEST_JOINT_STEP,
    PoseResidual,
    correct,
    evaluate_residual,
    residual_for,
    set_target,
)
from robots_planning.path_kinematics.pseudo_inverse import multiply, multiply_transposed, pseudo_inverse
from robots_planning.paths.cartesian_path_kernel import PathArrays

PULL = 12.0  # towards the guide, per path
FIRST_STEP = 1.0 / 32.0
LARGEST_BEND = 1e-6  # rad (m), between a sample and the fourth-order integration from the sample before it


@compiled()
def follow_guide(
    chain: ChainArrays,
    limits: Array,
    path: PathArrays,
    start: Array,
    guide: tuple[Array, Array],
    samples: JointSamples,
) -> tuple[int, int]:
    """Follow a path as `follow` does, with self-motion towards a guide g(s).

    q' = h + J^+ (x' - J h) with h = g' + pull (g - q); q'' is its derivative (Golub and Pereyra 1973).

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        start: Joint positions at s = 0, (n,).
        guide: Breaks (m + 1,) and coefficients (4, m, n) of a cubic spline, highest power first.
        samples: Filled; see `follow`.

    Returns:
        As `follow`.
    """
    s, q = samples[0], samples[1]
    breaks = guide[0]
    s[0], q[0] = 0.0, start
    residual = residual_for(start.size)
    set_target(path, 0.0, residual)
    evaluate_residual(chain, start, residual)
    if not _guided(guide, samples, 0, residual):
        return SINGULAR_START, 1
    count, step, piece, path_piece = 1, FIRST_STEP, 1, 1
    while s[count - 1] < 1.0:
        here = count - 1
        piece = next_break(breaks, s[here], piece)
        path_piece = next_break(path[0], s[here], path_piece)
        border = min(breaks[piece], path[0][path_piece])
        end = min(s[here] + step, border)
        if border - end < SHORTEST_STEP:
            end = border
        s[count] = end
        deviation = _advance_guided(chain, path, guide, samples, here, residual)
        step = next_step(end - s[here], deviation)
        outcome = judge(limits, samples, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled()
def _advance_guided(
    chain: ChainArrays,
    path: PathArrays,
    guide: tuple[Array, Array],
    samples: JointSamples,
    i: int,
    residual: PoseResidual,
) -> float:
    """Fill sample i + 1 at its s; return the deviation in between, or -1 if the step is too long."""
    s, q = samples[0], samples[1]
    n, j = q.shape[1], i + 1
    guess = np.empty(n)
    extrapolate(samples, i, guess)
    set_target(path, s[j], residual)
    for _ in range(3):
        if not correct(chain, guess, residual):
            return -1.0
        q[j] = guess
        if not _guided(guide, samples, j, residual):
            return -1.0
        integrate(samples, i, guess)
    for k in range(n):
        # The difference of the sample from the fourth-order integration measures the bend of the quintic.
        if not abs(q[j, k] - q[i, k]) <= LARGEST_JOINT_STEP or not abs(guess[k] - q[j, k]) <= LARGEST_BEND:
            return -1.0
    interpolate(samples, i, guess)
    set_target(path, 0.5 * (s[i] + s[j]), residual)
    deviation = evaluate_residual(chain, guess, residual)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled()
def _guided(guide: tuple[Array, Array], samples: JointSamples, i: int, residual: PoseResidual) -> bool:
    """Fill q' and q'' of sample i, at which the residual was evaluated."""
    s, q, q_s, q_ss = samples
    n = q.shape[1]
    x_s, x_ss, J, J_s, P, row, other = (
        residual.x_s,
        residual.x_ss,
        residual.J,
        residual.J_s,
        residual.P,
        residual.rest,
        residual.twist,
    )
    h, h_s, added, inner = np.empty(n), np.empty(n), np.empty(n), residual.step
    breaks, c = guide
    piece = min(max(np.searchsorted(breaks, s[i], side='right') - 1, 0), breaks.size - 2)
    x = s[i] - breaks[piece]
    pseudo_inverse(J, P, residual.solver)
    for k in range(n):
        g = ((c[0, piece, k] * x + c[1, piece, k]) * x + c[2, piece, k]) * x + c[3, piece, k]
        g_s = (3.0 * c[0, piece, k] * x + 2.0 * c[1, piece, k]) * x + c[2, piece, k]
        h[k] = g_s + PULL * (g - q[i, k])
        h_s[k] = 6.0 * c[0, piece, k] * x + 2.0 * c[1, piece, k] + PULL * g_s
    multiply(J, h, row)
    for k in range(6):
        row[k] = x_s[k] - row[k]
    multiply(P, row, added)
    for k in range(n):
        q_s[i, k] = h[k] + added[k]
        h_s[k] -= PULL * q_s[i, k]
    multiply(J, q_s[i], row)
    for k in range(6):
        if not abs(row[k] - x_s[k]) <= DERIVATIVE_TOLERANCE * (1.0 + np.abs(x_s).max()):
            return False
    jacobian_der(J, q_s[i], J_s)
    # h' + J^+ (x'' - J' q' - J h') + (I - J^+ J) J'^T J^+T (q' - h)
    multiply(J_s, q_s[i], row)
    multiply(J, h_s, other)
    for k in range(6):
        row[k] = x_ss[k] - row[k] - other[k]
    multiply(P, row, q_ss[i])
    multiply_transposed(P, added, row)
    multiply_transposed(J_s, row, inner)
    multiply(J, inner, row)
    multiply(P, row, added)
    for k in range(n):
        q_ss[i, k] += h_s[k] + inner[k] - added[k]
    return True
