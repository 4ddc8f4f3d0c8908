# ruff: noqa: PLR0917, C901, PLR0912  # compiled loops over arrays
"""The search of the damped least squares, compiled."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.inverse_kinematics.redundancy import (
    NO_CRITERION,
    RedundancyArrays,
    desired_displacement,
)
from robots_core.blocks.inverse_kinematics.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

DAMPING_START = 1e-2
DAMPING_GROWTH = 8.0
DAMPING_HIGHEST = 1e8  # above it a step is shorter than rounding, and the search ends
# Newton's last steps shrink the error by orders of magnitude; damping of this size does not slow them.
DAMPING_LOWEST = 1e-14
LARGEST_STEP = 1.5  # rad (m) per axis; the linearisation does not hold beyond it
# The search is restarted when this many steps together reduce the cost by less than the factor, as it does
# along a limit. Chosen by trial on three robots of the benchmark; fewer steps leave good starts too early.
PROGRESS_STEPS = 5
PROGRESS_FACTOR = 0.5
PATIENT = 0
# Self-motion: fraction of the criterion's displacement per step, number of steps, correction steps back to
# the pose after each, and the displacement below which it ends (rad).
SELF_MOTION_PART = 0.5
SELF_MOTION_STEPS = 40
CORRECTION_STEPS = 6
SELF_MOTION_END = 1e-5
NULL_SPACE_DAMPING = 1e-6

Options = tuple[float, float, int, int]
"""Position tolerance (m), orientation tolerance (rad), steps per start, and steps after which a start without
progress is abandoned (PATIENT: never)."""


@compiled()
def solve_pose(
    chain: ChainArrays,
    limits: Array,
    starts: Array,
    redundancy: RedundancyArrays,
    options: Options,
    target: tuple[Array, Array],
    q: Array,
    error: Array,
) -> int:
    """Search joint positions for a pose from `q`, then from each of `starts` until one converges.

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (2, n): lower, upper.
        starts: (k, n), inside the limits.
        redundancy: Arrays of a `Redundancy`.
        options: See `Options`.
        target: r (3,) and T (3, 3).
        q: Start, (n,); replaced by the solution, or the closest joint positions found.
        error: Filled: pose error at `q`, (6,).

    Returns:
        Steps taken, over all starts.
    """
    n = q.size
    first = q.copy()
    steps = search(chain, limits, options, target, q, error)
    if not reached(error, options) and starts.shape[0] > 0:
        other, other_error = np.empty(n), np.empty(6)
        for start in range(starts.shape[0]):
            other[:] = starts[start]
            steps += search(chain, limits, options, target, other, other_error)
            if _square(other_error) < _square(error):
                q[:] = other
                error[:] = other_error
            if reached(error, options):
                break
    if not reached(error, options):  # all steps for the closest point
        patient = (options[0], options[1], options[2], PATIENT)
        steps += search(chain, limits, patient, target, q, error)
    if redundancy[0] != NO_CRITERION and reached(error, options):
        steps += _self_motion(chain, limits, redundancy, options, target, q, error)
    _turn_near(first, chain[2], limits, q)
    return steps


@compiled()
def search(
    chain: ChainArrays,
    limits: Array,
    options: Options,
    target: tuple[Array, Array],
    q: Array,
    error: Array,
) -> int:
    """Levenberg-Marquardt from `q` inside the limits; fills q and error, returns the steps taken."""
    n = q.size
    r, T = np.empty(3), np.empty((3, 3))
    J, next_J = np.empty((6, n)), np.empty((6, n))
    next_q, next_error = np.empty(n), np.empty(6)
    A, gradient, step = np.empty((n, n)), np.empty(n), np.empty(n)
    free = np.empty(n, np.bool_)
    window = options[3]
    past = np.empty(max(window, 1))
    for i in range(n):
        q[i] = min(max(q[i], limits[0, i]), limits[1, i])
    pose_and_jacobian(chain, q, r, T, J)
    error_between(r, T, target[0], target[1], error)
    cost = _square(error)
    damping, growth = DAMPING_START, DAMPING_GROWTH
    for iteration in range(options[2]):
        if reached(error, options):
            return iteration
        if window != PATIENT:
            slot = iteration % window
            if iteration >= window and cost > PROGRESS_FACTOR * past[slot]:
                return iteration
            past[slot] = cost
        while True:
            damped_step(J, error, q, limits, damping, free, A, gradient, step)
            for i in range(n):
                # Rounding of q + step may pass a limit by one unit in the last place.
                next_q[i] = min(max(q[i] + step[i], limits[0, i]), limits[1, i])
            pose_and_jacobian(chain, next_q, r, T, next_J)
            error_between(r, T, target[0], target[1], next_error)
            next_cost = _square(next_error)
            if next_cost < cost:
                break
            damping, growth = max(damping, 1e-9) * growth, 2.0 * growth
            if damping > DAMPING_HIGHEST:
                return iteration + 1
        # Close to the solution damping decreases with the error: the last steps are those of Newton's method.
        damping, growth = max(min(damping / DAMPING_GROWTH**2, next_cost), DAMPING_LOWEST), DAMPING_GROWTH
        cost = next_cost
        q[:] = next_q
        error[:] = next_error
        J, next_J = next_J, J
    return options[2]


@compiled()
def damped_step(
    J: Array,
    error: Array,
    q: Array,
    limits: Array,
    damping: float,
    free: NDArray[np.bool_],
    A: Array,
    gradient: Array,
    step: Array,
) -> None:
    """Fill the damped step, (n,); an axis that would pass its limit stops there, the others are solved again.

    `free`, `A` (n, n) and `gradient` (n,) are scratch.
    """
    n = q.size
    rest = error.copy()
    for i in range(n):
        step[i] = 0.0
        pull = 0.0
        for row in range(6):
            pull += J[row, i] * error[row]
        free[i] = not ((q[i] <= limits[0, i] and pull < 0.0) or (q[i] >= limits[1, i] and pull > 0.0))
    while True:
        for i in range(n):
            if not free[i]:
                continue
            value = 0.0
            for row in range(6):
                value += J[row, i] * rest[row]
            gradient[i] = value
            for j in range(i + 1):
                if free[j]:
                    value = 0.0
                    for row in range(6):
                        value += J[row, i] * J[row, j]
                    A[i, j] = value
            A[i, i] += damping
        _solve_free(A, gradient, free)
        stopped = False
        for i in range(n):
            if not free[i]:
                continue
            step[i] = min(max(gradient[i], limits[0, i] - q[i]), limits[1, i] - q[i])
            if step[i] != gradient[i]:
                stopped = True
        if not stopped:
            break
        left = False
        for i in range(n):
            if not free[i]:
                continue
            if step[i] != gradient[i]:
                free[i] = False
                for row in range(6):
                    rest[row] -= J[row, i] * step[i]
            else:
                left = True
        if not left:
            break
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(step[i]))
    if largest > LARGEST_STEP:
        for i in range(n):
            step[i] *= LARGEST_STEP / largest


@compiled()
def _solve_free(A: Array, b: Array, free: NDArray[np.bool_]) -> None:
    """Solve A x = b for the free rows and columns, by Cholesky in place (lower triangle); x replaces b."""
    n = b.size
    for i in range(n):
        if not free[i]:
            continue
        for j in range(i):
            if not free[j]:
                continue
            value = A[i, j]
            for k in range(j):
                if free[k]:
                    value -= A[i, k] * A[j, k]
            A[i, j] = value / A[j, j]
        value = A[i, i]
        for k in range(i):
            if free[k]:
                value -= A[i, k] * A[i, k]
        # Damping below the rounding of a singular J^T J: the smallest pivot that still divides.
        A[i, i] = sqrt(max(value, 1e-18))
    for i in range(n):
        if free[i]:
            value = b[i]
            for k in range(i):
                if free[k]:
                    value -= A[i, k] * b[k]
            b[i] = value / A[i, i]
    for i in range(n - 1, -1, -1):
        if free[i]:
            value = b[i]
            for k in range(i + 1, n):
                if free[k]:
                    value -= A[k, i] * b[k]
            b[i] = value / A[i, i]


@compiled()
def _self_motion(
    chain: ChainArrays,
    limits: Array,
    redundancy: RedundancyArrays,
    options: Options,
    target: tuple[Array, Array],
    q: Array,
    error: Array,
) -> int:
    """Move towards the redundancy criterion by self-motion, which keeps the pose; return the steps taken."""
    n = q.size
    r, T, J, desired = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty(n)
    candidate, candidate_error = np.empty(n), np.empty(6)
    correction = (options[0], options[1], CORRECTION_STEPS, PATIENT)
    steps, part = 0, SELF_MOTION_PART
    for _ in range(SELF_MOTION_STEPS):
        pose_and_jacobian(chain, q, r, T, J)
        desired_displacement(redundancy, q, J, desired)
        for i in range(n):  # directions that the limits exclude
            if (q[i] <= limits[0, i] and desired[i] < 0.0) or (q[i] >= limits[1, i] and desired[i] > 0.0):
                desired[i] = 0.0
        A = J @ J.T
        for row in range(6):
            A[row, row] += NULL_SPACE_DAMPING
        desired -= J.T @ np.linalg.solve(A, J @ desired)
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(desired[i]))
        if part * largest < SELF_MOTION_END:
            break
        factor = min(part, LARGEST_STEP / largest)
        for i in range(n):
            candidate[i] = q[i] + factor * desired[i]
        steps += 1 + search(chain, limits, correction, target, candidate, candidate_error)
        if reached(candidate_error, options):
            q[:] = candidate
            error[:] = candidate_error
        else:
            part *= 0.5
    return steps


@compiled()
def _turn_near(reference: Array, prismatic: NDArray[np.bool_], limits: Array, q: Array) -> None:
    """Add full turns inside the limits, so that each axis is nearest to the reference."""
    turn = 2.0 * np.pi
    for i in range(q.size):
        if prismatic[i]:
            continue
        turned = q[i] + turn * np.round((reference[i] - q[i]) / turn)
        if limits[0, i] <= turned <= limits[1, i]:
            q[i] = turned


@compiled()
def reached(error: Array, options: Options) -> bool:
    """Both errors are inside the tolerances."""
    position = error[0] * error[0] + error[1] * error[1] + error[2] * error[2]
    orientation = error[3] * error[3] + error[4] * error[4] + error[5] * error[5]
    return bool(position <= options[0] * options[0] and orientation <= options[1] * options[1])


@compiled()
def _square(error: Array) -> float:
    value = 0.0
    for row in range(6):
        value += error[row] * error[row]
    return value


@compiled()
def solve_poses(
    chain: ChainArrays,
    limits: Array,
    starts: Array,
    redundancy: RedundancyArrays,
    options: Options,
    r: Array,
    T: Array,
    q: Array,
    errors: Array,
    steps: NDArray[np.int64],
) -> None:
    """`solve_pose` for many: r (m, 3), T (m, 3, 3), q (m, n), errors (m, 6), steps (m,)."""
    for pose in range(r.shape[0]):
        target = (r[pose], T[pose])
        steps[pose] = solve_pose(chain, limits, starts, redundancy, options, target, q[pose], errors[pose])
