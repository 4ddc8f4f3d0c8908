# ruff: noqa: PLR0917  # compiled functions take arrays
"""Compiled sums with Coulomb friction: an axis slides or stands still exactly.

With A symmetric and positive definite, w^T A w / 2 - b^T w + sum_j hold_j |w_j| has one minimum, where
A w = b less the friction of the axes that move, and the others need no more than `hold` to stand (time
stepping after Moreau 1988).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

# Sweeps end when no velocity changes by more than rounding of the largest; this number suffices for strongly
# coupled axes, and a remaining error is removed in the next step.
SWEEP_TOLERANCE: Final = 1e-13
MAX_SWEEPS: Final = 200


@compiled(nrt=False)
def add_losses(losses: Array, q_dot: Array, M: Array, tau_aux: Array) -> None:
    """Add losses (3, n), rows reflected inertia, Coulomb and viscous friction, to M and tau_aux."""
    for j in range(q_dot.size):
        M[j, j] += losses[0, j]
        tau_aux[j] += losses[1, j] * np.sign(q_dot[j]) + losses[2, j] * q_dot[j]


@compiled()
def accelerations(losses: Array, q_dot: Array, M: Array, tau: Array) -> Array:
    """q_ddot (n,) of M q_ddot = tau - friction of axes at rest, which stand until it is overcome.

    They minimise q_ddot^T M q_ddot / 2 - tau^T q_ddot + sum_j coulomb_j |q_ddot_j|.
    """
    n = tau.size
    q_ddot, hold = np.zeros(n), np.zeros(n)
    stands = np.zeros(n, dtype=np.bool_)
    solve_free(M, tau, hold, stands, np.empty((n, n)), q_ddot)
    for j in range(n):
        if q_dot[j] == 0.0 and losses[1, j] > 0.0:
            hold[j] = losses[1, j]
    if hold.any():
        sweep(M, tau, hold, q_ddot)
    return q_ddot


@compiled(nrt=False)
def sweep(A: Array, b: Array, hold: Array, w: Array) -> None:
    """Bring w to the minimum, axis by axis (coordinate descent)."""
    size = b.size
    for _ in range(MAX_SWEEPS):
        change, largest = 0.0, 1e-9
        for i in range(size):
            rest = b[i]
            for j in range(size):
                if j != i:
                    rest -= A[i, j] * w[j]
            if rest > hold[i]:
                value = (rest - hold[i]) / A[i, i]
            elif rest < -hold[i]:
                value = (rest + hold[i]) / A[i, i]
            else:
                value = 0.0
            change = max(change, abs(value - w[i]))
            largest = max(largest, abs(value))
            w[i] = value
        if change <= SWEEP_TOLERANCE * largest:
            return


@compiled(nrt=False)
def solve_free(A: Array, b: Array, friction: Array, stands: NDArray[np.bool_], L: Array, w: Array) -> None:
    """Fill w by Cholesky's method: A w = b - friction, with those at rest fixed at zero.

    L (m, m) is memory.
    """
    size = b.size
    L[:] = 0.0
    for i in range(size):
        if stands[i]:
            w[i] = 0.0
            continue
        total = b[i] - friction[i]
        for j in range(i + 1):
            if stands[j]:
                continue
            value = A[i, j]
            for k in range(j):
                value -= L[i, k] * L[j, k]
            L[i, j] = np.sqrt(value) if i == j else value / L[j, j]
        for j in range(i):
            total -= L[i, j] * w[j]
        w[i] = total / L[i, i]
    for i in range(size - 1, -1, -1):
        if stands[i]:
            continue
        total = w[i]
        for j in range(i + 1, size):
            total -= L[j, i] * w[j]
        w[i] = total / L[i, i]
