# ruff: noqa: PLR0917, C901  # compiled loops over arrays
"""The search of the damped least squares, compiled."""

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.inverse_kinematics.redundancy import (
    NO_CRITERION,
    RedundancyArrays,
    desired_displacement,
)
from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.kernels.small_matrices import damped_gram, solve_free, solve_lower, solve_transposed
from robots_core.kernels.vectors import copy_into
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

Tolerances = tuple[float, float]
"""Of position (m) and orientation (rad)."""
Arm = tuple[ChainArrays, Array, Tolerances]
"""Arrays of a `SerialChain`; limits (2, n), lower and upper; what is near enough to a pose."""
Effort = tuple[int, int]
"""Steps per start, and steps after which a start without progress is abandoned (PATIENT: never)."""
Target = tuple[Array, Array]
"""r (3,) and T (3, 3)."""
Memory = tuple[Array, Array, Array, Array, NDArray[np.bool_]]
"""For a step: two matrices (n, n), two vectors (n,), and which axes stand, (n,)."""


@compiled()
def solve_pose(
    arm: Arm,
    starts: Array,
    redundancy: RedundancyArrays,
    effort: Effort,
    target: Target,
    q: Array,
    error: Array,
) -> int:
    """Search joint positions for a pose from `q`, (n,), then from each of `starts`, (k, n).

    Ends with the first solution. Replaces q by it, or by the closest joint positions found, and fills their
    pose error, (6,).

    Returns:
        Steps taken, over all starts.
    """
    n = q.size
    first = q.copy()
    steps = search(arm, effort, target, q, error)
    _, _, tolerances = arm
    if not reached(tolerances, error) and starts.shape[0] > 0:
        other, other_error = np.empty(n), np.empty(6)
        for start in range(starts.shape[0]):
            copy_into(other, starts[start])
            steps += search(arm, effort, target, other, other_error)
            if _square(other_error) < _square(error):
                copy_into(q, other)
                copy_into(error, other_error)
            if reached(tolerances, error):
                break
    if not reached(tolerances, error):  # all steps for the closest point
        steps += search(arm, (effort[0], PATIENT), target, q, error)
    if redundancy[0] != NO_CRITERION and reached(tolerances, error):
        steps += _self_motion(arm, redundancy, target, q, error)
    _turn_near(first, arm, q)
    return steps


@compiled()
def search(arm: Arm, effort: Effort, target: Target, q: Array, error: Array) -> int:
    """Levenberg-Marquardt from `q` inside the limits; fills q and error, returns the steps taken."""
    chain, limits, tolerances = arm
    n = q.size
    r, T = np.empty(3), np.empty((3, 3))
    J, next_J = np.empty((6, n)), np.empty((6, n))
    next_q, next_error = np.empty(n), np.empty(6)
    memory = (np.empty((n, n)), np.empty((n, n)), np.empty(n), np.empty(n), np.empty(n, np.bool_))
    step = np.empty(n)
    most, window = effort
    past = np.empty(max(window, 1))
    for i in range(n):
        q[i] = min(max(q[i], limits[0, i]), limits[1, i])
    pose_and_jacobian(chain, q, r, T, J)
    error_between(r, T, target[0], target[1], error)
    cost = _square(error)
    damping, growth = DAMPING_START, DAMPING_GROWTH
    for iteration in range(most):
        if reached(tolerances, error):
            return iteration
        if window != PATIENT:
            slot = iteration % window
            if iteration >= window and cost > PROGRESS_FACTOR * past[slot]:
                return iteration
            past[slot] = cost
        while True:
            _damped_step(J, error, q, limits, damping, memory, step)
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
        copy_into(q, next_q)
        copy_into(error, next_error)
        J, next_J = next_J, J
    return most


@compiled()
def _damped_step(
    J: Array, error: Array, q: Array, limits: Array, damping: float, memory: Memory, step: Array
) -> None:
    """Fill the damped step, (n,); axes that would pass a limit stop there, the others are solved anew."""
    A, L, gradient, free_step, stands = memory
    n = q.size
    for i in range(n):
        step[i] = 0.0
        gradient[i] = 0.0
        for row in range(6):
            gradient[i] += J[row, i] * error[row]
        stands[i] = (q[i] <= limits[0, i] and gradient[i] < 0.0) or (
            q[i] >= limits[1, i] and gradient[i] > 0.0
        )
        for j in range(i + 1):
            value = damping if i == j else 0.0
            for row in range(6):
                value += J[row, i] * J[row, j]
            A[i, j] = A[j, i] = value
    stopped = True
    while stopped:
        for i in range(n):
            free_step[i] = gradient[i]
            for j in range(n):
                free_step[i] -= A[i, j] * step[j]
        solve_free(A, stands, L, free_step)
        stopped = False
        for i in range(n):
            inside = min(max(free_step[i], limits[0, i] - q[i]), limits[1, i] - q[i])
            if not stands[i] and inside != free_step[i]:
                step[i], stands[i], stopped = inside, True, True
    largest = 0.0
    for i in range(n):
        step[i] += free_step[i]
        largest = max(largest, abs(step[i]))
    if largest > LARGEST_STEP:
        for i in range(n):
            step[i] *= LARGEST_STEP / largest


@compiled()
def _self_motion(arm: Arm, redundancy: RedundancyArrays, target: Target, q: Array, error: Array) -> int:
    """Move towards the redundancy criterion by self-motion, which keeps the pose; return the steps taken."""
    chain, limits, tolerances = arm
    n = q.size
    r, T, J, desired = np.empty(3), np.empty((3, 3)), np.empty((6, n)), np.empty(n)
    candidate, candidate_error = np.empty(n), np.empty(6)
    L, task = np.empty((6, 6)), np.empty(6)
    steps, part = 0, SELF_MOTION_PART
    for _ in range(SELF_MOTION_STEPS):
        pose_and_jacobian(chain, q, r, T, J)
        desired_displacement(redundancy, q, J, desired)
        for i in range(n):  # directions that the limits exclude
            if (q[i] <= limits[0, i] and desired[i] < 0.0) or (q[i] >= limits[1, i] and desired[i] > 0.0):
                desired[i] = 0.0
        damped_gram(J, NULL_SPACE_DAMPING, L)
        for row in range(6):
            task[row] = 0.0
            for i in range(n):
                task[row] += J[row, i] * desired[i]
        solve_lower(L, task)
        solve_transposed(L, task)
        for i in range(n):
            for row in range(6):
                desired[i] -= J[row, i] * task[row]
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(desired[i]))
        if part * largest < SELF_MOTION_END:
            break
        factor = min(part, LARGEST_STEP / largest)
        for i in range(n):
            candidate[i] = q[i] + factor * desired[i]
        steps += 1 + search(arm, (CORRECTION_STEPS, PATIENT), target, candidate, candidate_error)
        if reached(tolerances, candidate_error):
            copy_into(q, candidate)
            copy_into(error, candidate_error)
        else:
            part *= 0.5
    return steps


@compiled()
def _turn_near(reference: Array, arm: Arm, q: Array) -> None:
    """Add full turns inside the limits, so that each axis is nearest to the reference."""
    chain, limits, _ = arm
    turn = 2.0 * np.pi
    for i in range(q.size):
        if chain[i, 12] != 0.0:
            continue
        turned = q[i] + turn * np.round((reference[i] - q[i]) / turn)
        if limits[0, i] <= turned <= limits[1, i]:
            q[i] = turned


@compiled()
def reached(tolerances: Tolerances, error: Array) -> bool:
    """Both errors are inside the tolerances."""
    most_position, most_orientation = tolerances
    position = error[0] * error[0] + error[1] * error[1] + error[2] * error[2]
    orientation = error[3] * error[3] + error[4] * error[4] + error[5] * error[5]
    return bool(
        position <= most_position * most_position and orientation <= most_orientation * most_orientation
    )


@compiled()
def _square(error: Array) -> float:
    value = 0.0
    for row in range(6):
        value += error[row] * error[row]
    return value


@compiled()
def solve_poses(
    arm: Arm,
    starts: Array,
    redundancy: RedundancyArrays,
    effort: Effort,
    r: Array,
    T: Array,
    q: Array,
    errors: Array,
    steps: NDArray[np.int64],
) -> None:
    """`solve_pose` for many: r (m, 3), T (m, 3, 3), q (m, n), errors (m, 6), steps (m,)."""
    for pose in range(r.shape[0]):
        target = (r[pose], T[pose])
        steps[pose] = solve_pose(arm, starts, redundancy, effort, target, q[pose], errors[pose])
