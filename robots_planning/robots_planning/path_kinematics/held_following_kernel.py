# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""A path along which the tool holds its position, and of its orientation what the arm can, compiled."""

import numpy as np

from robots_core.blocks.inverse_kinematics.closest_orientation_kernel import correct, rate
from robots_core.blocks.inverse_kinematics.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import (
    FOLLOWED,
    JOINT_TOLERANCE,
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
from robots_planning.path_kinematics.pose_residual_kernel import LARGEST_JOINT_STEP
from robots_planning.paths.cartesian_path_kernel import PathArrays, pose_on_path

FIRST_STEP = 1.0 / 16.0
TOLERANCE = 1e-12  # m and rad; conditions whose derivatives are differences converge to no less
CORRECTION_STEPS = 6
DIFFERENCE = 1e-5  # of the path, for q''
Target = tuple[Array, Array, Array, Array]
"""r (3,), T (3, 3), x' and x'' (6,) of a path at one s."""


@compiled()
def follow_held(
    chain: ChainArrays, limits: Array, path: PathArrays, start: Array, rows: int, samples: JointSamples
) -> tuple[int, int]:
    """Follow a path as `follow` does, holding less than its poses.

    q' keeps the conditions of `closest_orientation_kernel`; q'' is its difference along the path.

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        path: Arrays of a `CartesianPath`.
        start: Joint positions at s = 0, (n,).
        rows: 3 to hold the position alone, 3 + n for the closest orientation too.
        samples: Filled; see `follow`.

    Returns:
        As `follow`.
    """
    s, q = samples[0], samples[1]
    breaks = path[0]
    s[0], q[0] = 0.0, start
    target = (np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6))
    if not _derivatives(chain, path, samples, 0, rows, target):
        return SINGULAR_START, 1
    count, step, piece = 1, FIRST_STEP, 1
    while s[count - 1] < 1.0:
        here = count - 1
        piece = next_break(breaks, s[here], piece)
        end = min(s[here] + step, breaks[piece])
        if breaks[piece] - end < SHORTEST_STEP:
            end = breaks[piece]
        s[count] = end
        deviation = _advance(chain, path, samples, here, rows, target)
        step = next_step(end - s[here], deviation)
        outcome = judge(limits, samples, here, step, deviation)
        if outcome == FOLLOWED:
            count += 1
        elif outcome != TOO_FAR:
            return outcome, count
    return FOLLOWED, count


@compiled()
def _set(path: PathArrays, s: float, target: Target) -> None:
    pose_on_path(path, s, target[0], target[1], target[2], target[3])


@compiled()
def _derivatives(
    chain: ChainArrays, path: PathArrays, samples: JointSamples, i: int, rows: int, target: Target
) -> bool:
    """Fill q' and q'' of sample i."""
    s, q, q_s, q_ss = samples
    first, second = np.empty(q.shape[1]), np.empty(q.shape[1])
    _set(path, s[i], target)
    if not rate(chain, q[i], target[0], target[1], target[2], rows, q_s[i]):
        return False
    _set(path, s[i] - DIFFERENCE, target)
    fine = rate(chain, q[i] - DIFFERENCE * q_s[i], target[0], target[1], target[2], rows, first)
    _set(path, s[i] + DIFFERENCE, target)
    fine = fine and rate(chain, q[i] + DIFFERENCE * q_s[i], target[0], target[1], target[2], rows, second)
    q_ss[i] = (second - first) / (2.0 * DIFFERENCE)
    return fine


@compiled()
def _advance(
    chain: ChainArrays, path: PathArrays, samples: JointSamples, i: int, rows: int, target: Target
) -> float:
    """Fill sample i + 1 at its s; return the deviation in between, or -1 if the step is too long."""
    s, q = samples[0], samples[1]
    n, j = q.shape[1], i + 1
    guess = np.empty(n)
    extrapolate(samples, i, guess)
    # Where the position leaves axes free, it does not determine q: the integration is repeated.
    for again in range(2 if rows == 3 and n > 3 else 1):
        if again:
            integrate(samples, i, guess)
        _set(path, s[j], target)
        if not correct(
            chain, guess, target[0], target[1], rows, TOLERANCE, CORRECTION_STEPS, LARGEST_JOINT_STEP
        ):
            return -1.0
        q[j] = guess
        if not _derivatives(chain, path, samples, j, rows, target):
            return -1.0
    for k in range(n):
        if not abs(q[j, k] - q[i, k]) <= LARGEST_JOINT_STEP:
            return -1.0
    interpolate(samples, i, guess)
    _set(path, 0.5 * (s[i] + s[j]), target)
    deviation = _deviation(chain, guess, rows, target)
    return deviation if deviation <= PATH_TOLERANCE else -1.0


@compiled()
def _deviation(chain: ChainArrays, q: Array, rows: int, target: Target) -> float:
    """Deviation at joint positions `q`: of the tool, or of the axes, scaled to the same tolerance."""
    n = q.size
    r, T, J, error = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty(6)
    pose_and_jacobian(chain, q, r, T, J)
    error_between(r, T, target[0], target[1], error)
    deviation: float = max(abs(error[0]), abs(error[1]), abs(error[2]))
    if deviation > PATH_TOLERANCE or rows == 3:
        return deviation
    exact = q.copy()
    if not correct(chain, exact, target[0], target[1], rows, TOLERANCE, CORRECTION_STEPS, LARGEST_JOINT_STEP):
        return np.inf
    for k in range(n):
        deviation = max(deviation, abs(exact[k] - q[k]) * PATH_TOLERANCE / JOINT_TOLERANCE)
    return deviation
