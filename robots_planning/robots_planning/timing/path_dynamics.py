# ruff: noqa: PLR0917  # compiled functions take arrays
"""Torque limits along a path as functions of path speed and acceleration, compiled."""

import numpy as np

from robots_core.kernels.chain_dynamics import (
    Bodies,
    DynamicsArrays,
    bodies_of,
    fill_dynamics,
    fill_torques,
)
from robots_core.kernels.compiled import compiled
from robots_core.validation import Array

Memory = tuple[Bodies, Array, Array, Array]
"""Scratch memory for the dynamics of one state: bodies, mass matrix (n, n), bias and weight (n,)."""


@compiled()
def memory_for(n: int) -> Memory:
    """Scratch memory for a robot of n axes."""
    return bodies_of(n), np.empty((n, n)), np.empty(n), np.empty(n)


@compiled()
def torque_rows(
    dynamics: DynamicsArrays, q: Array, q_s: Array, q_ss: Array, effort: Array, rows: Array, memory: Memory
) -> None:
    """Fill rows (m, n, 3): torque = a s_ddot + b s_dot^2 + c, divided by its limit.

    a = M q', b = M q'' + C(q, q') q', c = gravity (Bobrow, Dubowsky and Gibson 1985).
    """
    bodies, M, bias, weight = memory
    m, n = q.shape
    for i in range(m):
        fill_dynamics(dynamics, q[i], q_s[i], bodies, M, bias, weight)
        for j in range(n):
            first, second = 0.0, bias[j] - weight[j]
            for k in range(n):
                first += M[j, k] * q_s[i, k]
                second += M[j, k] * q_ss[i, k]
            rows[i, j, 0] = first / effort[j]
            rows[i, j, 1] = second / effort[j]
            rows[i, j, 2] = weight[j] / effort[j]


@compiled()
def torque_use(
    dynamics: DynamicsArrays, q: Array, q_dot: Array, q_ddot: Array, effort: Array, use: Array, bodies: Bodies
) -> None:
    """Fill use (m, n): torque over its limit."""
    m, n = q.shape
    for i in range(m):
        fill_torques(dynamics, q[i], q_dot[i], q_ddot[i], bodies, use[i])
        for j in range(n):
            use[i, j] = abs(use[i, j]) / effort[j]
