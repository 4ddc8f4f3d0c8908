# ruff: noqa: PLR0917, SIM110  # compiled loops over arrays
"""Postures of a redundant robot along a path, compiled: sampled self-motion, and the cheapest way through."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.inverse_kinematics.chain import ChainArrays, pose_and_jacobian
from robots_core.blocks.inverse_kinematics.chain_derivative import jacobian_der
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array
from robots_planning.trajectory_generators.cartesian_path_kernel import PathArrays, pose_on_path
from robots_planning.trajectory_generators.least_motion import (
    least_motion,
    multiply,
    multiply_transposed,
    pseudo_inverse,
)
from robots_planning.trajectory_generators.path_following_kernel import (
    FOLLOWED,
    LARGEST_KNOT_MOTION,
    PATH_TOLERANCE,
    SHORTEST_STEP,
    SINGULAR_START,
    TOO_FAR,
    Knots,
    correct,
    judge,
    next_break,
    next_step,
    path_error,
)

SPACING = 0.12  # rad (m) of the axis that moves most, between neighbouring postures of one pose
MOST_POSTURES = 160  # of one pose
# Postures of neighbouring poses that are further apart, in rad (m) of one axis, do not follow each other.
LARGEST_MOTION = 0.35
NOWHERE = -1
INSIDE_STEPS = 4
INSIDE_MOTION = 0.3  # rad (m) of the axis that moves most, in one step
INSIDE_ROOM = 1e-3  # rad (m)
RELAXATION = 0.3  # part of the way to the smoother posture that one step goes
PULL = 12.0  # towards the guide, per path
GUIDED_FIRST_STEP = 1.0 / 32.0


@compiled()
def sample_layer(
    chain: ChainArrays,
    limits: Array,
    path: PathArrays,
    s: float,
    seeds: Array,
    nodes: Array,
) -> int:
    """Fill nodes (k, n) with postures of the pose at s that are joined to `seeds` (m, n), and return k.

    From every seed, corrected to the pose, self-motion is followed both ways until a limit or a posture that
    is known already.
    """
    n = seeds.shape[1]
    count = 0
    q, way, first = np.empty(n), np.empty(n), np.empty(n)
    for seed in range(seeds.shape[0]):
        q[:] = seeds[seed]
        if not correct(chain, path, s, q) or not _brought_inside(chain, limits, path, s, q):
            continue
        if _known(nodes, count, q, 0.6 * SPACING) or count >= nodes.shape[0]:
            continue
        first[:] = q
        nodes[count] = q
        count += 1
        for side in range(2):
            q[:] = first
            _null_direction(chain, q, way)
            if side == 1:
                way *= -1.0
            while count < nodes.shape[0]:
                q += SPACING * way
                if not correct(chain, path, s, q) or not _inside(limits, q):
                    break
                if _known(nodes, count, q, 0.6 * SPACING):
                    break
                nodes[count] = q
                count += 1
                last = way.copy()
                _null_direction(chain, q, way)
                if np.dot(last, way) < 0.0:
                    way *= -1.0
    return count


@compiled()
def _inside(limits: Array, q: Array) -> bool:
    for k in range(q.size):
        if not limits[0, k] <= q[k] <= limits[1, k]:
            return False
    return True


@compiled()
def _brought_inside(chain: ChainArrays, limits: Array, path: PathArrays, s: float, q: Array) -> bool:
    """Self-motion, in place, that brings axes back that are a little outside; False if it does not."""
    n = q.size
    way = np.empty(n)
    for _ in range(INSIDE_STEPS):
        worst, excess = NOWHERE, 0.0
        for k in range(n):
            outside = max(limits[0, k] - q[k], q[k] - limits[1, k])
            if outside > excess:
                worst, excess = k, outside
        if worst == NOWHERE:
            return True
        _null_direction(chain, q, way)
        goal = max(limits[0, worst] + INSIDE_ROOM, min(q[worst], limits[1, worst] - INSIDE_ROOM)) - q[worst]
        if INSIDE_MOTION * abs(way[worst]) < abs(goal):
            return False
        q += goal / way[worst] * way
        if not correct(chain, path, s, q):
            return False
    return False


@compiled()
def _known(nodes: Array, count: int, q: Array, distance: float) -> bool:
    for i in range(count):
        if _apart(nodes[i], q) < distance:
            return True
    return False


@compiled()
def _apart(p: Array, q: Array) -> float:
    largest = 0.0
    for k in range(q.size):
        largest = max(largest, abs(p[k] - q[k]))
    return largest


@compiled()
def _null_direction(chain: ChainArrays, q: Array, way: Array) -> None:
    """Fill the joint motion (n,) that leaves the pose; its largest entry is 1 rad (m)."""
    n = q.size
    r, T, J, P = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty((n, 6))
    pose_and_jacobian(chain, q, r, T, J)
    pseudo_inverse(J, P)
    N = np.eye(n) - P @ J
    axis = 0
    for k in range(n):
        if N[k, k] > N[axis, axis]:
            axis = k
    way[:] = N[:, axis]
    largest = 0.0
    for k in range(n):
        largest = max(largest, abs(way[k]))
    way /= largest


@compiled()
def follow_layers(
    chain: ChainArrays, limits: Array, path: PathArrays, s: Array, start: Array, layers: Array
) -> tuple[int, NDArray[np.int64]]:
    """Fill layers (m, k, n), postures of the poses at s (m,), the first `start` alone.

    Returns:
        Number of layers that have postures, and how many each has, (m,).
    """
    m, n = s.size, start.size
    counts = np.zeros(m, np.int64)
    layers[0, 0] = start
    counts[0] = 1
    r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, n))
    x_s, x_ss, step = np.empty(6), np.empty(6), np.empty(n)
    for i in range(1, m):
        seeds = layers[i - 1, : counts[i - 1]].copy()
        pose_on_path(path, s[i - 1], r, T, x_s, x_ss)
        for k in range(seeds.shape[0]):
            pose_and_jacobian(chain, seeds[k], r, T, J)
            least_motion(J, x_s, step)
            if (s[i] - s[i - 1]) * np.abs(step).max() < LARGEST_MOTION:
                seeds[k] += (s[i] - s[i - 1]) * step
        counts[i] = sample_layer(chain, limits, path, s[i], seeds, layers[i])
        if counts[i] == 0:
            return i, counts
    return m, counts


@compiled()
def cheapest_postures(layers: Array, counts: NDArray[np.int64], velocity: Array, chosen: Array) -> int:
    """Fill chosen (m, n) with the postures that the axes pass soonest at full speed.

    Returns:
        The first layer that cannot be reached, or m.
    """
    m, n = chosen.shape
    cost = np.full((m, layers.shape[1]), np.inf)
    came = np.full((m, layers.shape[1]), NOWHERE)
    cost[0, 0] = 0.0
    for i in range(1, m):
        reached = False
        for k in range(counts[i]):
            for j in range(counts[i - 1]):
                if cost[i - 1, j] >= cost[i, k]:
                    continue
                way, time = 0.0, 0.0
                for axis in range(n):
                    moved = abs(layers[i, k, axis] - layers[i - 1, j, axis])
                    way, time = max(way, moved), max(time, moved / velocity[axis])
                if way <= LARGEST_MOTION and cost[i - 1, j] + time < cost[i, k]:
                    cost[i, k], came[i, k] = cost[i - 1, j] + time, j
                    reached = True
        if not reached:
            return i
    node = int(np.argmin(cost[m - 1, : counts[m - 1]]))
    for i in range(m - 1, -1, -1):
        chosen[i] = layers[i, node]
        node = came[i, node]
    return int(m)


@compiled()
def relax(
    chain: ChainArrays, limits: Array, path: PathArrays, s: Array, margin: float, rounds: int, q: Array
) -> None:
    """Smooth postures q (m, n) at s (m,) by self-motion, the first one fixed, `margin` inside the limits."""
    m, n = q.shape
    r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, n))
    wish, reached, back, moved = np.empty(n), np.empty(6), np.empty(n), np.empty(n)
    for _ in range(rounds):
        for i in range(1, m):
            for k in range(n):
                # The end is free: there the smoothest is to go on as before.
                target = 0.5 * (q[i - 1, k] + q[i + 1, k]) if i < m - 1 else 2.0 * q[i - 1, k] - q[i - 2, k]
                wish[k] = RELAXATION * (target - q[i, k])
            pose_and_jacobian(chain, q[i], r, T, J)
            multiply(J, wish, reached)
            least_motion(J, reached, back)
            for k in range(n):
                moved[k] = q[i, k] + wish[k] - back[k]
            if not correct(chain, path, s[i], moved):
                continue
            good = True
            for k in range(n):
                room = min(margin, 0.25 * (limits[1, k] - limits[0, k]))
                low, high = min(limits[0, k] + room, q[i, k]), max(limits[1, k] - room, q[i, k])
                good = good and low <= moved[k] <= high
            if good:
                q[i] = moved


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
    if not _guided(chain, path, guide, knots, 0):
        return SINGULAR_START, 1
    count, step, piece, path_piece = 1, GUIDED_FIRST_STEP, 1, 1
    while s[count - 1] < 1.0:
        here = count - 1
        piece = next_break(breaks, s[here], piece)
        path_piece = next_break(path[0], s[here], path_piece)
        border = min(breaks[piece], path[0][path_piece])
        end = min(s[here] + step, border)
        if border - end < SHORTEST_STEP:
            end = border
        s[count] = end
        deviation = _advance_guided(chain, path, guide, knots, here)
        step = next_step(end - s[here], deviation)
        outcome = judge(limits, knots, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled()
def _advance_guided(
    chain: ChainArrays, path: PathArrays, guide: tuple[Array, Array], knots: Knots, i: int
) -> float:
    """Fill knot i + 1 at its s; the deviation in between, or -1 if the step is too long."""
    s, q, q_s, q_ss = knots
    n = q.shape[1]
    j, h = i + 1, s[i + 1] - s[i]
    guess, error = np.empty(n), np.empty(6)
    for k in range(n):
        guess[k] = q[i, k] + h * (q_s[i, k] + 0.5 * h * q_ss[i, k])
    for _ in range(3):
        if not correct(chain, path, s[j], guess):
            return -1.0
        q[j] = guess
        if not _guided(chain, path, guide, knots, j):
            return -1.0
        for k in range(n):
            guess[k] = q[i, k] + 0.5 * h * (q_s[i, k] + q_s[j, k]) + h * h / 12.0 * (q_ss[i, k] - q_ss[j, k])
    for k in range(n):
        # What integration to fourth order and the knot differ by is what the quintic has to bend for.
        if not abs(q[j, k] - q[i, k]) <= LARGEST_KNOT_MOTION or not abs(guess[k] - q[j, k]) <= 1e-6:
            return -1.0
        guess[k] = (
            0.5 * (q[i, k] + q[j, k])
            + 5.0 / 32.0 * h * (q_s[i, k] - q_s[j, k])
            + h * h / 64.0 * (q_ss[i, k] + q_ss[j, k])
        )
    deviation = path_error(chain, path, 0.5 * (s[i] + s[j]), guess, error)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled()
def _guided(chain: ChainArrays, path: PathArrays, guide: tuple[Array, Array], knots: Knots, i: int) -> bool:
    """Fill q' and q'' of knot i."""
    s, q, q_s, q_ss = knots
    n = q.shape[1]
    r, T, J, J_s, P = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty((6, n)), np.empty((n, 6))
    x_s, x_ss, row, other = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    h, h_s, added, inner = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    breaks, c = guide
    piece = min(max(np.searchsorted(breaks, s[i], side='right') - 1, 0), breaks.size - 2)
    x = s[i] - breaks[piece]
    pose_on_path(path, s[i], r, T, x_s, x_ss)
    pose_and_jacobian(chain, q[i], r, T, J)
    pseudo_inverse(J, P)
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
        if not abs(row[k] - x_s[k]) <= 1e-7 * (1.0 + np.abs(x_s).max()):
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
