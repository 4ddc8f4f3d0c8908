"""Compiled sums with Coulomb friction: an axis slides or stands still exactly.

With A symmetric and positive definite, w^T A w / 2 - b^T w + sum_j hold_j |w_j| has one minimum, where
A w = b less the friction of the axes that move, and the others need no more than `hold` to stand (time
stepping after Moreau 1988).
"""

from typing import Final

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.small_matrices import solve_free
from robots_core.validation import Array

# Sweeps end when no velocity changes by more than rounding of the largest; this number suffices for strongly
# coupled axes, and a remaining error is removed in the next step.
SWEEP_TOLERANCE: Final = 1e-13
MAX_SWEEPS: Final = 200


@compiled()
def accelerations(losses: Array, q_dot: Array, M: Array, tau: Array) -> Array:
    """q_ddot (n,) of M q_ddot = tau - friction of axes at rest, which stand until it is overcome.

    `losses` (3, n): reflected inertia, which is in M already, Coulomb and viscous friction. The accelerations
    minimise q_ddot^T M q_ddot / 2 - tau^T q_ddot + sum_j coulomb_j |q_ddot_j|.
    """
    n = tau.size
    q_ddot, hold = tau.copy(), np.zeros(n)
    solve_free(M, np.zeros(n, dtype=np.bool_), np.empty((n, n)), q_ddot)
    for j in range(n):
        if q_dot[j] == 0.0 and losses[1, j] > 0.0:
            hold[j] = losses[1, j]
    if hold.any():
        sweep(M, tau, hold, q_ddot)
    return q_ddot


@compiled()
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
