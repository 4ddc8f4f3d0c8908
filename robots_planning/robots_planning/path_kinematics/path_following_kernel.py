# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Inverse kinematics along a Cartesian path, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.inverse_kinematics.serial_chain import ChainArrays
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array
from robots_planning.path_kinematics.pose_residual_kernel import (
    LARGEST_KNOT_MOTION,
    View,
    aim_at,
    correct,
    derivatives,
    look_from,
    view_of,
)
from robots_planning.path_kinematics.pseudo_inverse import apply_pseudo_inverse
from robots_planning.paths.cartesian_path_kernel import PathArrays
from robots_planning.timing.quintic import quintic_coefficients, quintics_at

FIRST_STEP = 1.0 / 16.0
LONGEST_STEP = 1.0 / 8.0
SHORTEST_STEP = 1e-8  # of the path; a joint path that needs finer knots jumps
MOST_KNOTS = 4000
# Between knots the tool may leave the path by this much, in m and rad; 1e-5 is what users are promised.
PATH_TOLERANCE = 2e-7
# And the axes by this much, rad (m): close to a singularity the tool hardly tells.
JOINT_TOLERANCE = 1e-5
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
    return _follow(chain, limits, path, start, knots, np.empty(start.size), view_of(start.size))


@compiled(nrt=False)
def _follow(
    chain: ChainArrays, limits: Array, path: PathArrays, start: Array, knots: Knots, guess: Array, view: View
) -> tuple[int, int]:
    """`follow` with memory for a guess (n,) and a view."""
    s, q, q_s, q_ss = knots
    breaks = path[0]
    s[0] = 0.0
    for k in range(start.size):
        q[0, k] = start[k]
    aim_at(path, 0.0, view)
    look_from(chain, start, view)
    if not derivatives(view, q_s[0], q_ss[0]):
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
        deviation = _advance(chain, path, knots, here, guess, view)
        step = next_step(end - s[here], deviation)
        outcome = judge(limits, knots, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled(nrt=False)
def judge(limits: Array, knots: Knots, i: int, step: float, deviation: float) -> int:
    """FOLLOWED if knot i + 1 stands, TOO_FAR if another one comes before it, or why the path ends there."""
    if deviation < 0.0:
        return BLOCKED if step < SHORTEST_STEP else TOO_FAR
    if leaves_limits(limits, knots, i):
        return OUTSIDE
    return FULL if i + 1 == MOST_KNOTS and knots[0][i + 1] < 1.0 else FOLLOWED


@compiled(nrt=False)
def next_break(breaks: Array, s: float, piece: int) -> int:
    """The first of increasing breaks, from `piece` on, that is a step ahead of s; else the last one."""
    while piece < breaks.size - 1 and breaks[piece] - s < SHORTEST_STEP:
        piece += 1
    return piece


@compiled(nrt=False)
def next_step(step: float, deviation: float) -> float:
    """The step after one that left the path by `deviation` in between; -1 if it was too long."""
    if deviation < 0.0:
        return 0.5 * step
    # The deviation grows with the sixth power of the step.
    growth: float = 0.9 * (PATH_TOLERANCE / max(deviation, 1e-16)) ** (1.0 / 6.0)
    return min(step * min(max(growth, 0.5), 2.0), LONGEST_STEP)


@compiled(nrt=False)
def _advance(chain: ChainArrays, path: PathArrays, knots: Knots, i: int, guess: Array, view: View) -> float:
    """Fill knot i + 1 at its s; the deviation in between, or -1 if the step is too long."""
    s, q, q_s, q_ss = knots
    n, j = guess.size, i + 1
    extrapolate(knots, i, guess)
    aim_at(path, s[j], view)
    # The tool does not determine a redundant axis.
    for again in range(2 if n > 6 else 1):
        if again:
            integrate(knots, i, guess)
        if not correct(chain, guess, view):
            return -1.0
        for k in range(n):
            q[j, k] = guess[k]
        if not derivatives(view, q_s[j], q_ss[j]):
            return -1.0
    for k in range(n):
        if not abs(q[j, k] - q[i, k]) <= LARGEST_KNOT_MOTION:
            return -1.0
    interpolate(knots, i, guess)
    aim_at(path, 0.5 * (s[i] + s[j]), view)
    deviation = _deviation(chain, guess, view)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled(nrt=False)
def extrapolate(knots: Knots, i: int, guess: Array) -> None:
    """Fill a guess (n,) at the s of knot i + 1, from knot i alone."""
    s, q, q_s, q_ss = knots
    h = s[i + 1] - s[i]
    for k in range(guess.size):
        guess[k] = q[i, k] + h * (q_s[i, k] + 0.5 * h * q_ss[i, k])


@compiled(nrt=False)
def integrate(knots: Knots, i: int, guess: Array) -> None:
    """Fill the guess (n,) at the s of knot i + 1 to fourth order (Hermite), with the derivatives there."""
    s, q, q_s, q_ss = knots
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(guess.size):
        guess[k] = q[i, k] + 0.5 * h * (q_s[i, k] + q_s[j, k]) + h * h / 12.0 * (q_ss[i, k] - q_ss[j, k])


@compiled(nrt=False)
def interpolate(knots: Knots, i: int, middle: Array) -> None:
    """Fill the middle (n,) of the quintic from knot i to the next."""
    s, q, q_s, q_ss = knots
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(middle.size):
        middle[k] = (
            0.5 * (q[i, k] + q[j, k])
            + 5.0 / 32.0 * h * (q_s[i, k] - q_s[j, k])
            + h * h / 64.0 * (q_ss[i, k] + q_ss[j, k])
        )


@compiled(nrt=False)
def _deviation(chain: ChainArrays, q: Array, view: View) -> float:
    """How far a posture is off: of the tool, or of the axes as part of what they may be."""
    deviation = look_from(chain, q, view)
    if deviation > PATH_TOLERANCE:
        return deviation
    apply_pseudo_inverse(view.J, view.error, view.step, view.solver)
    for k in range(q.size):
        deviation = max(deviation, abs(view.step[k]) * PATH_TOLERANCE / JOINT_TOLERANCE)
    return deviation


@compiled(nrt=False)
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
        if _leaves_range(low, high, knots, i, k):
            return True
    return False


@compiled()
def _leaves_range(low: float, high: float, knots: Knots, i: int, axis: int) -> bool:
    """As `leaves_limits`, of one axis, looked at place by place."""
    s, q, q_s, q_ss = knots
    j, n = i + 1, q.shape[1]
    curve = np.empty((1, 6, n))
    quintic_coefficients(s[i : j + 1], q[i : j + 1], q_s[i : j + 1], q_ss[i : j + 1], curve)
    p, v, w = np.empty((BETWEEN, n)), np.empty((BETWEEN, n)), np.empty((BETWEEN, n))
    inside = s[i] + (s[j] - s[i]) * np.arange(1, BETWEEN + 1) / (BETWEEN + 1.0)
    quintics_at(s[i : j + 1], curve, inside, p, v, w)
    for row in range(BETWEEN):
        if not low <= p[row, axis] <= high:
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
    q, view = begin.copy(), view_of(begin.size)
    aim_at(path, s, view)
    for row in range(ends.shape[0]):
        still[row] = True
        # The middle tells most.
        for check in range(TURN_CHECKS):
            part = ((check + TURN_CHECKS // 2) % TURN_CHECKS) / (TURN_CHECKS - 1)
            for k in range(begin.size):
                q[k] = begin[k] + part * (ends[row, k] - begin[k])
                if not limits[0, k] - POSITION_TOLERANCE <= q[k] <= limits[1, k] + POSITION_TOLERANCE:
                    still[row] = False
            if not still[row] or not look_from(chain, q, view) <= STANDSTILL:
                still[row] = False
                break
