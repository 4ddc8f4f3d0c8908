# ruff: noqa: PLR0917  # compiled functions take arrays
"""A path's limits over path speed and acceleration, compiled."""

from __future__ import annotations

import numpy as np

from robots_core.blocks.inverse_kinematics.chain_dynamics import DynamicsArrays, mass_matrix_and_bias
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array


@compiled()
def torque_rows(
    dynamics: DynamicsArrays, q: Array, q_s: Array, q_ss: Array, effort: Array, rows: Array
) -> None:
    """Fill rows (m, n, 3): torque = a s_ddot + b s_dot^2 + c, divided by its limit.

    a = M q', b = M q'' + C(q, q') q', c = gravity (Bobrow, Dubowsky and Gibson 1985).
    """
    m, n = q.shape
    M, bias, rest, still = np.empty((n, n)), np.empty(n), np.empty(n), np.zeros(n)
    for i in range(m):
        mass_matrix_and_bias(dynamics, q[i], still, M, rest)
        mass_matrix_and_bias(dynamics, q[i], q_s[i], M, bias)
        for j in range(n):
            first, second = 0.0, bias[j] - rest[j]
            for k in range(n):
                first += M[j, k] * q_s[i, k]
                second += M[j, k] * q_ss[i, k]
            rows[i, j, 0] = first / effort[j]
            rows[i, j, 1] = second / effort[j]
            rows[i, j, 2] = rest[j] / effort[j]


@compiled()
def torque_use(
    dynamics: DynamicsArrays, q: Array, q_dot: Array, q_ddot: Array, effort: Array, use: Array
) -> None:
    """Fill use (m, n): torque over its limit."""
    m, n = q.shape
    M, bias = np.empty((n, n)), np.empty(n)
    for i in range(m):
        mass_matrix_and_bias(dynamics, q[i], q_dot[i], M, bias)
        for j in range(n):
            tau = bias[j]
            for k in range(n):
                tau += M[j, k] * q_ddot[i, k]
            use[i, j] = abs(tau) / effort[j]
