# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Inverse kinematics along a Cartesian path, compiled."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.inverse_kinematics.chain import ChainArrays, error_between, pose_and_jacobian
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
from robots_planning.trajectory_generators.quintic import quintic_coefficients, quintics_at

FIRST_STEP = 1.0 / 16.0
LONGEST_STEP = 1.0 / 8.0
SHORTEST_STEP = 1e-8  # of the path; a joint path that needs finer knots jumps
MOST_KNOTS = 4000
# Between knots the tool may leave the path by this much, in m and rad; 1e-5 is what users are promised.
PATH_TOLERANCE = 2e-7
# And the axes by this much, rad (m): close to a singularity the tool hardly tells.
JOINT_TOLERANCE = 1e-5
CORRECTION_TOLERANCE = 1e-13  # m and rad, at the knots; of the axes, that over the smallest singular value
CORRECTION_STEPS = 5
LARGEST_KNOT_MOTION = 0.25  # rad (m) of one axis from knot to knot; more may hide a change of configuration
LOST_MOTION = 1e-7  # part of the tool's motion along the path that may be missing in a singular posture
POSITION_TOLERANCE = 1e-9  # rad (m), of the axis limits
# While the posture turns over in a singularity the tool stays within this, m and rad.
STANDSTILL = 1e-6
TURN_CHECKS = 17
# Places looked at between knots where an axis may pass its limit.
BETWEEN = 64

FOLLOWED = 0
SINGULAR_START = 1
BLOCKED = 2
OUTSIDE = 3
FULL = 4
TOO_FAR = 5

Flags = NDArray[np.bool_]
Knots = tuple[Array, Array, Array, Array]
"""s (k,), q, q' and q'' (k, n)."""


@compiled()
def follow(
    chain: ChainArrays, limits: Array, path: PathArrays, start: Array, knots: Knots
) -> tuple[int, int]:
    """Follow a path with q' = J^+ x' and q'' = d/ds (J^+ x'), knot by knot, each corrected by Newton.

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        start: Joint positions at s = 0, (n,).
        knots: Filled; room for `MOST_KNOTS` + 1.

    Returns:
        FOLLOWED, or why not: SINGULAR_START, BLOCKED behind the last knot, OUTSIDE: one knot more is filled,
        at which an axis is outside its limits, FULL: there is no room for what follows. And the number of
        knots.
    """
    s, q, q_s, q_ss = knots
    breaks = path[0]
    n = start.size
    guess = np.empty(n)
    s[0] = 0.0
    q[0] = start
    if not _derivatives(chain, path, 0.0, q[0], q_s[0], q_ss[0]):
        return SINGULAR_START, 1
    count, step, piece = 1, FIRST_STEP, 1
    while s[count - 1] < 1.0:
        here = count - 1
        # The third derivative jumps between pieces: a knot belongs there.
        piece = next_break(breaks, s[here], piece)
        end = min(s[here] + step, breaks[piece])
        if breaks[piece] - end < SHORTEST_STEP:
            end = breaks[piece]
        s[count] = end
        deviation = _advance(chain, path, knots, here, guess)
        step = next_step(end - s[here], deviation)
        outcome = judge(limits, knots, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled()
def judge(limits: Array, knots: Knots, i: int, step: float, deviation: float) -> int:
    """FOLLOWED if knot i + 1 stands, TOO_FAR if another one comes before it, or why the path ends there."""
    if deviation < 0.0:
        return BLOCKED if step < SHORTEST_STEP else TOO_FAR
    if leaves_limits(limits, knots, i):
        return OUTSIDE
    return FULL if i + 1 == MOST_KNOTS and knots[0][i + 1] < 1.0 else FOLLOWED


@compiled()
def next_break(breaks: Array, s: float, piece: int) -> int:
    """The first of increasing breaks, from `piece` on, that is a step ahead of s; else the last one."""
    while piece < breaks.size - 1 and breaks[piece] - s < SHORTEST_STEP:
        piece += 1
    return piece


@compiled()
def next_step(step: float, deviation: float) -> float:
    """The step after one that left the path by `deviation` in between; -1 if it was too long."""
    if deviation < 0.0:
        return 0.5 * step
    # The deviation grows with the sixth power of the step.
    growth: float = 0.9 * (PATH_TOLERANCE / max(deviation, 1e-16)) ** (1.0 / 6.0)
    return min(step * min(max(growth, 0.5), 2.0), LONGEST_STEP)


@compiled()
def _advance(chain: ChainArrays, path: PathArrays, knots: Knots, i: int, guess: Array) -> float:
    """Fill knot i + 1 at its s; the deviation in between, or -1 if the step is too long."""
    s, q, q_s, q_ss = knots
    n = guess.size
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(n):
        guess[k] = q[i, k] + h * (q_s[i, k] + 0.5 * h * q_ss[i, k])
    if not correct(chain, path, s[j], guess):
        return -1.0
    q[j] = guess
    if not _derivatives(chain, path, s[j], q[j], q_s[j], q_ss[j]):
        return -1.0
    if n > 6:
        # The tool does not determine a redundant axis: integrate it to fourth order (Hermite).
        for k in range(n):
            guess[k] = q[i, k] + 0.5 * h * (q_s[i, k] + q_s[j, k]) + h * h / 12.0 * (q_ss[i, k] - q_ss[j, k])
        if not correct(chain, path, s[j], guess):
            return -1.0
        q[j] = guess
        if not _derivatives(chain, path, s[j], q[j], q_s[j], q_ss[j]):
            return -1.0
    for k in range(n):
        if not abs(q[j, k] - q[i, k]) <= LARGEST_KNOT_MOTION:
            return -1.0
        # The middle of the quintic between the knots.
        guess[k] = (
            0.5 * (q[i, k] + q[j, k])
            + 5.0 / 32.0 * h * (q_s[i, k] - q_s[j, k])
            + h * h / 64.0 * (q_ss[i, k] + q_ss[j, k])
        )
    deviation = _deviation(chain, path, 0.5 * (s[i] + s[j]), guess)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled()
def _deviation(chain: ChainArrays, path: PathArrays, s: float, q: Array) -> float:
    """How far a posture is from the path at `s`: of the tool, or of the axes as part of what they may be."""
    n = q.size
    J, error, step = np.empty((6, n)), np.empty(6), np.empty(n)
    deviation = _error_and_jacobian(chain, path, s, q, (np.empty(3), np.empty((3, 3)), J), error)
    if deviation > PATH_TOLERANCE:
        return deviation
    least_motion(J, error, step)
    for k in range(n):
        deviation = max(deviation, abs(step[k]) * PATH_TOLERANCE / JOINT_TOLERANCE)
    return deviation


@compiled()
def leaves_limits(limits: Array, knots: Knots, i: int) -> bool:
    """An axis is outside its limits between knot i and the next, which then becomes the place outside."""
    s, q, q_s, q_ss = knots
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(q.shape[1]):
        low, high = limits[0, k] - POSITION_TOLERANCE, limits[1, k] + POSITION_TOLERANCE
        if not low <= q[j, k] <= high:
            return True
        # A curve stays between the extremes of its Bezier points.
        a, b = 0.2 * h * q_s[i, k], 0.2 * h * q_s[j, k]
        c, d = 0.05 * h * h * q_ss[i, k], 0.05 * h * h * q_ss[j, k]
        smallest = min(q[i, k] + min(0.0, a, 2.0 * a + c), q[j, k] - max(0.0, b, 2.0 * b - d))
        largest = max(q[i, k] + max(0.0, a, 2.0 * a + c), q[j, k] - min(0.0, b, 2.0 * b - d))
        if low <= smallest and largest <= high:
            continue
        curve = np.empty((1, 6, q.shape[1]))
        quintic_coefficients(s[i : j + 1], q[i : j + 1], q_s[i : j + 1], q_ss[i : j + 1], curve)
        n = q.shape[1]
        p, v, w = np.empty((BETWEEN, n)), np.empty((BETWEEN, n)), np.empty((BETWEEN, n))
        inside = s[i] + h * np.arange(1, BETWEEN + 1) / (BETWEEN + 1.0)
        quintics_at(s[i : j + 1], curve, inside, p, v, w)
        for row in range(BETWEEN):
            if not low <= p[row, k] <= high:
                s[j] = inside[row]
                q[j] = p[row]
                return True
    return False


@compiled()
def stays_inside(limits: Array, knots: Knots) -> bool:
    """No axis is outside its limits, at the knots or between them."""
    s, q, q_s, q_ss = knots
    copy = (s.copy(), q.copy(), q_s, q_ss)  # where it leaves them is filled in
    inside = True
    for i in range(s.size - 1):
        inside = inside and not leaves_limits(limits, copy, i)
    return inside


@compiled()
def path_error(chain: ChainArrays, path: PathArrays, s: float, q: Array, error: Array) -> float:
    """Fill the pose error (6,) from posture `q` to the path at `s`; its largest entry."""
    r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, q.size))
    return _error_and_jacobian(chain, path, s, q, (r, T, J), error)


@compiled()
def stand_still(
    chain: ChainArrays, limits: Array, path: PathArrays, s: float, begin: Array, ends: Array, still: Flags
) -> None:
    """Fill whether the tool stays where the path is at `s` while the axes turn straight to each of `ends`.

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        s: Where.
        begin: Joint positions before, (n,).
        ends: Joint positions after, (k, n).
        still: Filled, (k,); False also where an axis leaves its limits.
    """
    q, error = np.empty(begin.size), np.empty(6)
    for row in range(ends.shape[0]):
        still[row] = True
        # The middle tells most.
        for check in range(TURN_CHECKS):
            part = ((check + TURN_CHECKS // 2) % TURN_CHECKS) / (TURN_CHECKS - 1)
            for k in range(begin.size):
                q[k] = begin[k] + part * (ends[row, k] - begin[k])
                if not limits[0, k] - POSITION_TOLERANCE <= q[k] <= limits[1, k] + POSITION_TOLERANCE:
                    still[row] = False
            if not still[row] or not path_error(chain, path, s, q, error) <= STANDSTILL:
                still[row] = False
                break


@compiled()
def _error_and_jacobian(
    chain: ChainArrays, path: PathArrays, s: float, q: Array, pose: tuple[Array, Array, Array], error: Array
) -> float:
    target, orientation = np.empty(3), np.empty((3, 3))
    pose_on_path(path, s, target, orientation, np.empty(6), np.empty(6))
    return _error_to(chain, (target, orientation), q, pose, error)


@compiled()
def _error_to(
    chain: ChainArrays, target: tuple[Array, Array], q: Array, pose: tuple[Array, Array, Array], error: Array
) -> float:
    """Fill the pose and Jacobian at `q`, and the error from there to the target (r, T); its largest entry."""
    r, T, J = pose
    pose_and_jacobian(chain, q, r, T, J)
    error_between(r, T, target[0], target[1], error)
    largest = 0.0
    for k in range(6):
        largest = max(largest, abs(error[k]))
    return largest


@compiled()
def correct(chain: ChainArrays, path: PathArrays, s: float, q: Array) -> bool:
    """Newton's method from a close guess, in place; False if it does not converge in a few steps."""
    n = q.size
    J, error, step = np.empty((6, n)), np.empty(6), np.empty(n)
    pose, target = (np.empty(3), np.empty((3, 3)), J), (np.empty(3), np.empty((3, 3)))
    pose_on_path(path, s, target[0], target[1], np.empty(6), np.empty(6))
    for _ in range(CORRECTION_STEPS):
        if _error_to(chain, target, q, pose, error) < CORRECTION_TOLERANCE:
            return True
        least_motion(J, error, step)
        for k in range(n):
            if not abs(step[k]) <= LARGEST_KNOT_MOTION:
                return False
        for k in range(n):
            q[k] += step[k]
    return False


@compiled()
def _derivatives(chain: ChainArrays, path: PathArrays, s: float, q: Array, q_s: Array, q_ss: Array) -> bool:
    """Fill q' and q'' at a point of the path; False where the posture cannot move along it."""
    n = q.size
    r, T, J = np.empty(3), np.empty((3, 3)), np.empty((6, n))
    x_s, x_ss = np.empty(6), np.empty(6)
    pose_on_path(path, s, r, T, x_s, x_ss)
    pose_and_jacobian(chain, q, r, T, J)
    P, J_s, reached = np.empty((n, 6)), np.empty((6, n)), np.empty(6)
    if n > 6:  # which needs the pseudo-inverse itself
        pseudo_inverse(J, P)
        multiply(P, x_s, q_s)
    else:
        least_motion(J, x_s, q_s)
    multiply(J, q_s, reached)
    missing, whole = 0.0, 0.0
    for k in range(6):
        missing += (x_s[k] - reached[k]) ** 2
        whole += x_s[k] ** 2
    if not sqrt(missing) <= LOST_MOTION * sqrt(whole):
        return False
    jacobian_der(J, q_s, J_s)
    multiply(J_s, q_s, reached)
    # Golub and Pereyra 1973: derivative of the pseudo-inverse, applied to x'.
    if n <= 6:
        least_motion(J, x_ss - reached, q_ss)
    else:
        multiply(P, x_ss - reached, q_ss)
        dual, inner, lifted, projected = np.empty(6), np.empty(n), np.empty(6), np.empty(n)
        multiply_transposed(P, q_s, dual)
        multiply_transposed(J_s, dual, inner)
        multiply(J, inner, lifted)
        multiply(P, lifted, projected)
        for k in range(n):
            q_ss[k] += inner[k] - projected[k]
    return True
