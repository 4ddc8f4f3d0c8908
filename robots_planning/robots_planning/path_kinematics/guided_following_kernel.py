# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""A path followed by a redundant robot, compiled: q' = J^+ x' with self-motion towards a guide."""

from __future__ import annotations

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
    Knots,
    extrapolate,
    integrate,
    interpolate,
    judge,
    next_break,
    next_step,
)
from robots_planning.path_kinematics.pose_residual_kernel import (
    LARGEST_KNOT_MOTION,
    LOST_MOTION,
    View,
    aim_at,
    correct,
    look_from,
    view_of,
)
from robots_planning.path_kinematics.pseudo_inverse import multiply, multiply_transposed, pseudo_inverse
from robots_planning.paths.cartesian_path_kernel import PathArrays

PULL = 12.0  # towards the guide, per path
FIRST_STEP = 1.0 / 32.0
LARGEST_BEND = 1e-6  # rad (m), between a knot and what integration to fourth order makes of the one before


@compiled()
def follow_guide(
    chain: ChainArrays,
    limits: Array,
    path: PathArrays,
    start: Array,
    guide: tuple[Array, Array],
    knots: Knots,
) -> tuple[int, int]:
    """Follow a path as `follow` does, with self-motion towards a guide g(s).

    q' = h + J^+ (x' - J h) with h = g' + pull (g - q); q'' is its derivative (Golub and Pereyra 1973).

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        start: Joint positions at s = 0, (n,).
        guide: Breaks (m + 1,) and coefficients (4, m, n) of a cubic spline, highest power first.
        knots: Filled; see `follow`.

    Returns:
        As `follow`.
    """
    s, q = knots[0], knots[1]
    breaks = guide[0]
    s[0], q[0] = 0.0, start
    view = view_of(start.size)
    aim_at(path, 0.0, view)
    look_from(chain, start, view)
    if not _guided(guide, knots, 0, view):
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
        deviation = _advance_guided(chain, path, guide, knots, here, view)
        step = next_step(end - s[here], deviation)
        outcome = judge(limits, knots, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled()
def _advance_guided(
    chain: ChainArrays, path: PathArrays, guide: tuple[Array, Array], knots: Knots, i: int, view: View
) -> float:
    """Fill knot i + 1 at its s; the deviation in between, or -1 if the step is too long."""
    s, q = knots[0], knots[1]
    n, j = q.shape[1], i + 1
    guess = np.empty(n)
    extrapolate(knots, i, guess)
    aim_at(path, s[j], view)
    for _ in range(3):
        if not correct(chain, guess, view):
            return -1.0
        q[j] = guess
        if not _guided(guide, knots, j, view):
            return -1.0
        integrate(knots, i, guess)
    for k in range(n):
        # What integration to fourth order and the knot differ by is what the quintic has to bend for.
        if not abs(q[j, k] - q[i, k]) <= LARGEST_KNOT_MOTION or not abs(guess[k] - q[j, k]) <= LARGEST_BEND:
            return -1.0
    interpolate(knots, i, guess)
    aim_at(path, 0.5 * (s[i] + s[j]), view)
    deviation = look_from(chain, guess, view)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled()
def _guided(guide: tuple[Array, Array], knots: Knots, i: int, view: View) -> bool:
    """Fill q' and q'' of knot i, which is in view."""
    s, q, q_s, q_ss = knots
    n = q.shape[1]
    x_s, x_ss, J, J_s, P, row, other = view.x_s, view.x_ss, view.J, view.J_s, view.P, view.rest, view.twist
    h, h_s, added, inner = np.empty(n), np.empty(n), np.empty(n), view.step
    breaks, c = guide
    piece = min(max(np.searchsorted(breaks, s[i], side='right') - 1, 0), breaks.size - 2)
    x = s[i] - breaks[piece]
    pseudo_inverse(J, P, view.solver)
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
        if not abs(row[k] - x_s[k]) <= LOST_MOTION * (1.0 + np.abs(x_s).max()):
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
