# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""Inverse kinematics along a Cartesian path, compiled."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays
from robots_core.kernels.vectors import copy_into
from robots_core.validation import Array
from robots_planning.path_kinematics.pose_residual_kernel import (
    LARGEST_JOINT_STEP,
    PoseResidual,
    correct,
    derivatives,
    evaluate_residual,
    place_target,
    rates_held,
    residual_for,
)
from robots_planning.path_kinematics.pseudo_inverse import apply_pseudo_inverse
from robots_planning.paths.cartesian_path_kernel import PathArrays
from robots_planning.timing.quintic import interval_at, quintic_coefficients, quintics_at

FIRST_STEP = 1.0 / 16.0
LONGEST_STEP = 1.0 / 8.0
SHORTEST_STEP = 1e-8  # of the path; a joint path that needs shorter steps is discontinuous
MAX_SAMPLES = 4000
# Largest deviation of the tool from the path between samples, m and rad; 1e-5 is promised.
PATH_TOLERANCE = 2e-7
# Largest deviation of the axes, rad (m): close to a singularity the tool hardly moves with them.
JOINT_TOLERANCE = 1e-5
# Largest deviation, rad (m), of a sample from the fourth-order integration of a guided path.
LARGEST_BEND = 1e-6
POSITION_TOLERANCE = 1e-9  # rad (m), of the axis limits
# Largest motion of the tool, m and rad, while the configuration changes in a singularity.
STANDSTILL = 1e-6
TURN_CHECKS = 17
# Points checked between two samples where an axis may pass its limit.
BETWEEN = 64

FOLLOWED = 0
SINGULAR_START = 1
BLOCKED = 2
OUTSIDE = 3
FULL = 4
TOO_FAR = 5

Flags = NDArray[np.bool_]
JointSamples = tuple[Array, Array, Array, Array]
"""s (k,), q, q' and q'' (k, n)."""


class FreeAxes(NamedTuple):
    """How axes move that a path leaves free.

    Attributes:
        pull: Towards the guide g(s), per path; 0 without one: then the axes have the smallest velocities.
        breaks: Of the guide, a cubic spline, (m + 1,); (0, 1) without one.
        guide: Its coefficients, (4, m, n), highest power first.
    """

    pull: float
    breaks: Array
    guide: Array


@compiled()
def follow(
    chain: ChainArrays,
    limits: Array,
    path: PathArrays,
    free: FreeAxes,
    rows: int,
    start: Array,
    samples: JointSamples,
) -> tuple[int, int]:
    """Follow a path with q' = J^+ x' and q'' = d/ds (J^+ x'), corrected by Newton's method at each sample.

    With a guide g(s), self-motion goes towards it: q' = h + J^+ (x' - J h) with h = g' + pull (g - q).

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        free: The guide.
        rows: As in `PoseResidual`.
        start: Joint positions at s = 0, (n,).
        samples: Filled; room for `MAX_SAMPLES` + 1.

    Returns:
        The outcome and the number of samples. Outcomes are FOLLOWED; SINGULAR_START; BLOCKED: no step is
        possible from the last sample; OUTSIDE: one more sample is filled, at which an axis is outside its
        limits; FULL: `MAX_SAMPLES` do not reach the end.
    """
    guess, residual = start.copy(), residual_for(chain, start.size, rows)
    s, q = samples[0], samples[1]
    s[0] = 0.0
    copy_into(q[0], start)
    place_target(residual, path, 0.0)
    evaluate_residual(residual, start)
    count, piece, guide_piece = 1, 1, 1
    if not _derivatives(residual, path, free, samples, 0):
        return SINGULAR_START, count
    # Towards a guide the axes turn faster at first.
    step = 0.5 * FIRST_STEP if free.pull > 0.0 else FIRST_STEP
    while s[count - 1] < 1.0:
        here = count - 1
        # The third derivative jumps between pieces, so a sample is placed there.
        piece = _next_break(path[0], s[here], piece)
        guide_piece = _next_break(free.breaks, s[here], guide_piece)
        border = min(path[0][piece], free.breaks[guide_piece])
        end = min(s[here] + step, border)
        s[count] = border if border - end < SHORTEST_STEP else end
        deviation = _advance(residual, path, free, samples, here, guess)
        step = _next_step(s[count] - s[here], deviation)
        outcome = _judge(limits, samples, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled()
def _judge(limits: Array, samples: JointSamples, i: int, step: float, deviation: float) -> int:
    """FOLLOWED to accept sample i + 1, TOO_FAR if the step must be shorter, or why the path ends there."""
    if deviation < 0.0:
        return BLOCKED if step < SHORTEST_STEP else TOO_FAR
    if leaves_limits(limits, samples, i):
        return OUTSIDE
    return FULL if i + 1 == MAX_SAMPLES and samples[0][i + 1] < 1.0 else FOLLOWED


@compiled()
def _next_break(breaks: Array, s: float, piece: int) -> int:
    """Index of the first break, from `piece` on, that is at least a step ahead of s; else of the last one."""
    while piece < breaks.size - 1 and breaks[piece] - s < SHORTEST_STEP:
        piece += 1
    return piece


@compiled()
def _next_step(step: float, deviation: float) -> float:
    """Length of the next step, after one with a `deviation` from the path; -1 means that it was too long."""
    if deviation < 0.0:
        return 0.5 * step
    # The deviation grows with the sixth power of the step.
    growth: float = 0.9 * (PATH_TOLERANCE / max(deviation, 1e-16)) ** (1.0 / 6.0)
    return min(step * min(max(growth, 0.5), 2.0), LONGEST_STEP)


@compiled()
def _advance(
    residual: PoseResidual, path: PathArrays, free: FreeAxes, samples: JointSamples, i: int, guess: Array
) -> float:
    """Fill sample i + 1 at its s; return the deviation in between, or -1 if the step is too long."""
    s, q = samples[0], samples[1]
    n, j = guess.size, i + 1
    _extrapolate(samples, i, guess)
    place_target(residual, path, s[j])
    # Where the target leaves axes free, it does not determine q: the integration is repeated.
    redundant = n > (residual.rows or 6)
    for again in range(3 if free.pull > 0.0 else 2 if redundant else 1):
        if again:
            _integrate(samples, i, guess)
        if not correct(residual, guess):
            return -1.0
        copy_into(q[j], guess)
        if not _derivatives(residual, path, free, samples, j):
            return -1.0
    if free.pull > 0.0:
        _integrate(samples, i, guess)
    for k in range(n):
        # The difference of the sample from the fourth-order integration measures the bend of the quintic.
        bend = guess[k] - q[j, k] if free.pull > 0.0 else 0.0
        if not abs(q[j, k] - q[i, k]) <= LARGEST_JOINT_STEP or not abs(bend) <= LARGEST_BEND:
            return -1.0
    _interpolate(samples, i, guess)
    place_target(residual, path, 0.5 * (s[i] + s[j]))
    deviation = _deviation(residual, guess)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled()
def _derivatives(
    residual: PoseResidual, path: PathArrays, free: FreeAxes, samples: JointSamples, i: int
) -> bool:
    """Fill q' and q'' of sample i, at which the residual was evaluated; False where there are none."""
    s, q, q_s, q_ss = samples
    if residual.rows > 0:
        return rates_held(residual, path, s[i], q[i], q_s[i], q_ss[i])
    desired, desired_s = np.zeros(q.shape[1]), np.zeros(q.shape[1])
    if free.pull > 0.0:
        piece, c = interval_at(free.breaks, s[i]), free.guide
        x = s[i] - free.breaks[piece]
        for k in range(q.shape[1]):
            g = ((c[0, piece, k] * x + c[1, piece, k]) * x + c[2, piece, k]) * x + c[3, piece, k]
            g_s = (3.0 * c[0, piece, k] * x + 2.0 * c[1, piece, k]) * x + c[2, piece, k]
            desired[k] = g_s + free.pull * (g - q[i, k])
            desired_s[k] = 6.0 * c[0, piece, k] * x + 2.0 * c[1, piece, k] + free.pull * g_s
    return derivatives(residual, desired, desired_s, free.pull, q_s[i], q_ss[i])


@compiled()
def _extrapolate(samples: JointSamples, i: int, guess: Array) -> None:
    """Fill a guess (n,) at the s of sample i + 1, from sample i alone."""
    s, q, q_s, q_ss = samples
    h = s[i + 1] - s[i]
    for k in range(guess.size):
        guess[k] = q[i, k] + h * (q_s[i, k] + 0.5 * h * q_ss[i, k])


@compiled()
def _integrate(samples: JointSamples, i: int, guess: Array) -> None:
    """Fill a guess (n,) at the s of sample i + 1 by fourth-order (Hermite) integration from sample i."""
    s, q, q_s, q_ss = samples
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(guess.size):
        guess[k] = q[i, k] + 0.5 * h * (q_s[i, k] + q_s[j, k]) + h * h / 12.0 * (q_ss[i, k] - q_ss[j, k])


@compiled()
def _interpolate(samples: JointSamples, i: int, middle: Array) -> None:
    """Fill the middle (n,) of the quintic from sample i to the next."""
    s, q, q_s, q_ss = samples
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(middle.size):
        middle[k] = (
            0.5 * (q[i, k] + q[j, k])
            + 5.0 / 32.0 * h * (q_s[i, k] - q_s[j, k])
            + h * h / 64.0 * (q_ss[i, k] + q_ss[j, k])
        )


@compiled()
def _deviation(residual: PoseResidual, q: Array) -> float:
    """Deviation at joint positions `q`: of the tool, or of the axes, scaled to the same tolerance."""
    deviation = evaluate_residual(residual, q)
    if residual.rows > 0:
        deviation = max(abs(residual.error[0]), abs(residual.error[1]), abs(residual.error[2]))
    if deviation > PATH_TOLERANCE:
        return deviation
    if residual.rows == 3:
        return deviation
    if residual.rows == 0:
        step = apply_pseudo_inverse(residual.J, residual.error)
    else:
        step = q.copy()
        if not correct(residual, step):
            return np.inf
        for k in range(q.size):
            step[k] -= q[k]
    for k in range(q.size):
        deviation = max(deviation, abs(step[k]) * PATH_TOLERANCE / JOINT_TOLERANCE)
    return deviation


@compiled()
def leaves_limits(limits: Array, samples: JointSamples, i: int) -> bool:
    """Whether an axis leaves its limits between sample i and the next, which is then moved to that place."""
    s, q, q_s, q_ss = samples
    j, h = i + 1, s[i + 1] - s[i]
    for k in range(q.shape[1]):
        low, high = limits[0, k] - POSITION_TOLERANCE, limits[1, k] + POSITION_TOLERANCE
        if not low <= q[j, k] <= high:
            return True
        # A curve lies in the convex hull of its Bezier points.
        a, b = 0.2 * h * q_s[i, k], 0.2 * h * q_s[j, k]
        c, d = 0.05 * h * h * q_ss[i, k], 0.05 * h * h * q_ss[j, k]
        smallest = min(q[i, k] + min(0.0, a, 2.0 * a + c), q[j, k] - max(0.0, b, 2.0 * b - d))
        largest = max(q[i, k] + max(0.0, a, 2.0 * a + c), q[j, k] - min(0.0, b, 2.0 * b - d))
        if low <= smallest and largest <= high:
            continue
        if _leaves_range(low, high, samples, i, k):
            return True
    return False


@compiled()
def _leaves_range(low: float, high: float, samples: JointSamples, i: int, axis: int) -> bool:
    """`leaves_limits` for one axis, checked point by point."""
    s, q, q_s, q_ss = samples
    j, n = i + 1, q.shape[1]
    curve = np.empty((1, 6, n))
    quintic_coefficients(s[i : j + 1], q[i : j + 1], q_s[i : j + 1], q_ss[i : j + 1], curve)
    p, v, w = np.empty((BETWEEN, n)), np.empty((BETWEEN, n)), np.empty((BETWEEN, n))
    inside = s[i] + (s[j] - s[i]) * np.arange(1, BETWEEN + 1) / (BETWEEN + 1.0)
    quintics_at(s[i : j + 1], curve, inside, p, v, w)
    for row in range(BETWEEN):
        if not low <= p[row, axis] <= high:
            s[j] = inside[row]
            copy_into(q[j], p[row])
            return True
    return False


@compiled()
def stays_inside(limits: Array, samples: JointSamples) -> bool:
    """Whether no axis is outside its limits, at the samples or between them."""
    s, q, q_s, q_ss = samples
    copy = (s.copy(), q.copy(), q_s, q_ss)  # `leaves_limits` writes the sample outside
    inside = True
    for i in range(s.size - 1):
        inside = inside and not leaves_limits(limits, copy, i)
    return inside


@compiled()
def stand_still(
    chain: ChainArrays, limits: Array, path: PathArrays, s: float, begin: Array, ends: Array, still: Flags
) -> None:
    """Fill whether the tool stays at the pose of `s` while the axes move straight to each of `ends`.

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        s: Path coordinate at which the tool stands still.
        begin: Joint positions before, (n,).
        ends: Joint positions after, (k, n).
        still: Filled, (k,); False also where an axis leaves its limits.
    """
    q, residual = begin.copy(), residual_for(chain, begin.size, 0)
    place_target(residual, path, s)
    for row in range(ends.shape[0]):
        still[row] = True
        # The middle deviates most.
        for check in range(TURN_CHECKS):
            part = ((check + TURN_CHECKS // 2) % TURN_CHECKS) / (TURN_CHECKS - 1)
            for k in range(begin.size):
                q[k] = begin[k] + part * (ends[row, k] - begin[k])
                if not limits[0, k] - POSITION_TOLERANCE <= q[k] <= limits[1, k] + POSITION_TOLERANCE:
                    still[row] = False
            if not still[row] or not evaluate_residual(residual, q) <= STANDSTILL:
                still[row] = False
                break
