# ruff: noqa: PLR0917  # compiled functions take arrays, not objects
"""The step of the constrained inverse kinematics, compiled."""

from math import sqrt
from typing import Any

import numpy as np

from robots_core.blocks.inverse_kinematics.quadratic_program import (
    INFEASIBLE,
    SOLVED,
    solve_factorised,
    solve_quadratic_program,
)
from robots_core.blocks.inverse_kinematics.redundancy import (
    NO_CRITERION,
    RedundancyArrays,
    desired_displacement,
)
from robots_core.blocks.inverse_kinematics.viability import (
    braking_distance,
    fastest_stoppable,
    velocity_interval,
)
from robots_core.kernels.chain_dynamics import DynamicsArrays, mass_matrix_and_bias
from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.kernels.small_matrices import damped_gram, factorise, solve_lower, solve_transposed
from robots_core.kernels.vectors import copy_into
from robots_core.validation import Array

POSITION, VELOCITY, ACCELERATION = 1, 2, 3
NOT_FINITE = -1
# Relative weight of joint motion: keeps the program strictly convex for redundant robots.
MOTION_WEIGHT = 1e-6
# Below this singular value (m or 1 per rad, weighted) motion is damped, most in the singularity itself
# (Nakamura and Hanafusa 1986).
SINGULAR_VALUE = 0.05
DAMPING = 0.03
# Fraction of the deceleration used for approaching the reference; the rest covers the linearisation error.
APPROACH_SHARE = 0.8
SMALLEST_SPEED_SHARE = 0.05
REDUNDANCY_RATE = 2.0  # 1/s
REDUNDANCY_SPEED_SHARE = 0.25
# Tolerance for identifying the active bound: rounding of sums of terms of order one.
SAME = 1e-9
OVERLOAD_MARGIN = 1e-9


@compiled()
def constrained_step(
    chain: ChainArrays,
    limits: Array,
    options: Array,
    redundancy: RedundancyArrays,
    dynamics: DynamicsArrays,
    state: Any,
    reference: Any,
    result: Any,
) -> int:
    """One step; see `ConstrainedInverseKinematics`.

    Args:
        chain: Arrays of a `SerialChain`.
        limits: (6, n): lower, upper, velocity, acceleration, deceleration of braking, effort.
        options: (4,): dt (s), gain (1/s), weights of position (1/m) and of orientation (1/rad).
        redundancy: Kind, preferred positions (n,) and weights (n,); see `Redundancy`.
        dynamics: Arrays of a `ChainDynamics`; with `NO_DYNAMICS`, M and tau_aux are those of the state.
        state: q (n,), q_dot (n,), M (n, n) and tau_aux (n,) at the start.
        reference: At the end of the period: r (3,), T (3, 3), twist (6,).
        result: Filled: values (4, n) of `ConstrainedStep`; errors (3,): position (m), orientation (rad),
            largest relative slack; active (2, n): per axis what bounds its velocity, and whether its torque
            is bounded, the sign being the side, 0 for nothing.

    Returns:
        Status of the quadratic program, or NOT_FINITE for a state or twist that is not.
    """
    q, q_dot, M, tau_aux = state
    motion, errors, active = result
    if not (np.isfinite(q).all() and np.isfinite(q_dot).all() and np.isfinite(reference[2]).all()):
        return NOT_FINITE
    n, dt = q.size, options[0]
    if dynamics[1].size > 0:
        mass_matrix_and_bias(dynamics, q, q_dot, M, tau_aux)
    pose_errors, J = np.empty(6), np.empty((6, n))
    H, gradients = _task(chain, options, state, reference, J, pose_errors)
    L = np.empty((n, n))
    factorise(H, L)
    f = _towards_reference(L, gradients, limits, options)
    if redundancy[0] != NO_CRITERION:
        _add_redundancy(redundancy, q, J, options, limits, f)
    low, high, C = np.empty(2 * n), np.empty(2 * n), np.empty((n, n))
    velocity_interval(q, q_dot, limits, dt, low, high)
    _torque_rows(q_dot, M, tau_aux, limits[5], dt, C, low, high)
    w, multipliers = np.empty(n), np.empty(2 * n)
    status = solve_factorised(L, f, low, high, C, w, multipliers)
    if status == INFEASIBLE:
        overload = _smallest_overload(low, high, C)
        for row in range(n, 2 * n):
            low[row] -= overload
            high[row] += overload
        status = solve_factorised(L, f, low, high, C, w, multipliers)
    if status != SOLVED:
        multipliers[:] = 0.0
        w[:] = 0.0
    _fill_motion(state, limits, dt, low, high, w, motion)
    errors[2] = _largest_slack(motion, limits, dt)
    _fill_active(q_dot, limits, dt, motion, multipliers, active)
    r, T = np.empty(3), np.empty((3, 3))
    pose_and_jacobian(chain, motion[0], r, T, J)
    error_between(r, T, reference[0], reference[1], pose_errors)
    errors[0] = sqrt(pose_errors[0] ** 2 + pose_errors[1] ** 2 + pose_errors[2] ** 2)
    errors[1] = sqrt(pose_errors[3] ** 2 + pose_errors[4] ** 2 + pose_errors[5] ** 2)
    return status


@compiled()
def _task(
    chain: ChainArrays, options: Array, state: Any, reference: Any, J: Array, error: Array
) -> tuple[Array, Array]:
    """Quadratic form of |W (J w - V - k e)|^2, damped near singularities, and J^T W^2 V and J^T W^2 e.

    Fills J and error, both weighted.
    """
    q, q_dot = state[0], state[1]
    twist = reference[2]
    n, dt = q.size, options[0]
    r, T = np.empty(3), np.empty((3, 3))
    # Displacement due to the velocity at the start of the period; the rest of it is dt w / 2.
    pose_and_jacobian(chain, q + 0.5 * dt * q_dot, r, T, J)
    error_between(r, T, reference[0], reference[1], error)
    rows = 0
    gradients = np.zeros((2, n))
    for row in range(6):
        weight = options[2] if row < 3 else options[3]
        error[row] = weight * (error[row] - 0.5 * dt * twist[row])
        for i in range(n):
            J[row, i] *= weight
            gradients[0, i] += J[row, i] * weight * twist[row]
            gradients[1, i] += J[row, i] * error[row]
        if weight > 0.0:
            rows += 1
    H, L = np.zeros((n, n)), np.empty((n, n))
    for row in range(6):
        for i in range(n):
            for j in range(n):
                H[i, j] += J[row, i] * J[row, j]
    factorise(H, L)
    # Close to the smallest squared singular value, and smooth in q where two of them cross.
    smallest = _harmonic_value(J, rows) if rows <= n else 1.0 / _inverse_trace(L)
    damping = MOTION_WEIGHT
    if smallest < SINGULAR_VALUE**2:
        damping += DAMPING**2 * (1.0 - smallest / SINGULAR_VALUE**2)
    for i in range(n):
        H[i, i] += damping
    return H, gradients


@compiled()
def _harmonic_value(J: Array, rows: int) -> float:
    """1 / trace((J J^T)^-1) over the rows of J that are not all zero."""
    chosen, used = np.empty((rows, J.shape[1])), 0
    for row in range(6):
        if used < rows and (J[row] != 0.0).any():
            copy_into(chosen[used], J[row])
            used += 1
    if used < rows:
        return 0.0
    L = np.empty((rows, rows))
    damped_gram(chosen, 0.0, L)
    return 1.0 / _inverse_trace(L)


@compiled()
def _inverse_trace(L: Array) -> float:
    """Trace of the inverse of a matrix with the Cholesky factor L: the squares of the factor's inverse."""
    n = L.shape[0]
    column, trace = np.empty(n), 0.0
    for j in range(n):
        column[:] = 0.0
        column[j] = 1.0
        solve_lower(L, column)
        for i in range(j, n):
            trace += column[i] * column[i]
    return trace


@compiled()
def _towards_reference(L: Array, gradients: Array, limits: Array, options: Array) -> Array:
    """Linear term (n,): the fastest approach from which every axis can stop when it reaches the reference."""
    velocity, deceleration = limits[2], limits[4]
    free = gradients.copy()
    for motion in free:
        solve_lower(L, motion)
        solve_transposed(L, motion)
    rate = options[1]
    for i in range(velocity.size):
        distance = abs(free[1, i])
        if distance > 0.0:
            fastest = fastest_stoppable(distance, APPROACH_SHARE * deceleration[i], options[0])
            left = max(velocity[i] - abs(free[0, i]), SMALLEST_SPEED_SHARE * velocity[i])
            rate = min(rate, fastest / distance, left / distance)
    f: Array = -gradients[0] - rate * gradients[1]
    return f


@compiled()
def _torque_rows(
    q_dot: Array, M: Array, tau_aux: Array, effort: Array, dt: float, C: Array, low: Array, high: Array
) -> None:
    """Fill C (n, n) and its bounds, from n on: torques M (w - q_dot) / dt + tau_aux over their limits."""
    n = q_dot.size
    for i in range(n):
        scale = 1.0 / (dt * effort[i])
        standing = tau_aux[i] / effort[i]
        for j in range(n):
            C[i, j] = M[i, j] * scale
            standing -= C[i, j] * q_dot[j]
        low[n + i] = -1.0 - standing
        high[n + i] = 1.0 - standing


@compiled()
def _add_redundancy(
    redundancy: RedundancyArrays, q: Array, J: Array, options: Array, limits: Array, f: Array
) -> None:
    """Add the displacement of the redundancy criterion to the linear term f, (n,)."""
    n = q.size
    desired = np.empty(n)
    desired_displacement(redundancy, q, J, desired)
    rate = REDUNDANCY_RATE
    for i in range(n):
        distance = abs(desired[i])
        if distance > 0.0:
            fastest = fastest_stoppable(distance, APPROACH_SHARE * limits[4, i], options[0])
            rate = min(rate, min(fastest, REDUNDANCY_SPEED_SHARE * limits[2, i]) / distance)
    for i in range(n):
        f[i] -= MOTION_WEIGHT * rate * desired[i]


@compiled()
def _smallest_overload(low: Array, high: Array, C: Array) -> float:
    """Smallest relative increase of all torque limits for which a motion exists."""
    n = C.shape[0]
    # Variables are w and the overload s >= 0, rows C w - s <= high and C w + s >= low.
    H, f = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    wide, x, multipliers = np.empty((2 * n, n + 1)), np.empty(n + 1), np.empty(3 * n + 1)
    wide_low, wide_high = np.full(3 * n + 1, -np.inf), np.full(3 * n + 1, np.inf)
    for i in range(n):
        H[i, i] = MOTION_WEIGHT
        wide_low[i], wide_high[i] = low[i], high[i]
        wide_high[n + 1 + i], wide_low[2 * n + 1 + i] = high[n + i], low[n + i]
        for j in range(n):
            wide[i, j] = wide[n + i, j] = C[i, j]
        wide[i, n], wide[n + i, n] = -1.0, 1.0
    H[n, n], wide_low[n] = 1.0, 0.0
    solve_quadratic_program(H, f, wide_low, wide_high, wide, x, multipliers)
    overload = float(x[n])
    return max(overload, 0.0) * (1.0 + OVERLOAD_MARGIN) + OVERLOAD_MARGIN


@compiled()
def _fill_motion(
    state: Any, limits: Array, dt: float, low: Array, high: Array, w: Array, motion: Array
) -> None:
    q, q_dot, M, tau_aux = state
    for i in range(q.size):
        end = min(max(w[i], low[i]), high[i])
        motion[1, i] = end
        motion[2, i] = (end - q_dot[i]) / dt
        motion[0, i] = q[i] + 0.5 * dt * (q_dot[i] + end)
        # The sum may round to one unit in the last place past the limit.
        if abs(motion[0, i] - limits[0, i]) < SAME:
            motion[0, i] = max(motion[0, i], limits[0, i])
        if abs(motion[0, i] - limits[1, i]) < SAME:
            motion[0, i] = min(motion[0, i], limits[1, i])
    for i in range(q.size):
        torque = tau_aux[i]
        for j in range(q.size):
            torque += M[i, j] * motion[2, j]
        motion[3, i] = torque


@compiled()
def _largest_slack(motion: Array, limits: Array, dt: float) -> float:
    largest = 0.0
    for i in range(motion.shape[1]):
        speed = motion[1, i]
        distance = braking_distance(abs(speed), limits[4, i], dt)
        over = motion[0, i] - limits[1, i] + (distance if speed > 0.0 else 0.0)
        under = limits[0, i] - motion[0, i] + (distance if speed < 0.0 else 0.0)
        if max(over, under) > SAME:
            largest = max(largest, max(over, under) / (limits[1, i] - limits[0, i]))
        for value, limit in ((speed, limits[2, i]), (motion[3, i], limits[5, i])):
            if abs(value) - limit > SAME * limit:
                largest = max(largest, (abs(value) - limit) / limit)
    return largest


@compiled()
def _fill_active(
    q_dot: Array, limits: Array, dt: float, motion: Array, multipliers: Array, active: Array
) -> None:
    n = q_dot.size
    for i in range(n):
        active[0, i] = 0
        sign = _sign(multipliers[i])
        if sign != 0:
            speed, rounding = sign * motion[1, i], SAME * limits[2, i]
            if speed >= sign * q_dot[i] + dt * limits[3, i] - rounding:
                active[0, i] = sign * ACCELERATION
            elif speed >= limits[2, i] - rounding:
                active[0, i] = sign * VELOCITY
            else:
                active[0, i] = sign * POSITION
        active[1, i] = _sign(multipliers[n + i])


@compiled()
def _sign(value: float) -> int:
    return 1 if value > 0.0 else -1 if value < 0.0 else 0
