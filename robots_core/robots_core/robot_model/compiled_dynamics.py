"""The sum of a rigid robot's torques, compiled: faster than numpy for a few values."""

from robots_core.kernels.compiled import compiled
from robots_core.kernels.loaded_numba import nb
from robots_core.validation import Array

_Numbers = nb.types.Array(nb.float64, 1, 'A', readonly=True)


@compiled(nb.boolean(nb.float64[:, ::1], _Numbers, nb.float64[::1], nb.float64[::1]), nogil=False)
def torque_sum(M: Array, q_ddot: Array, tau_aux: Array, tau: Array) -> bool:
    """Fill tau (n,) with M q_ddot + tau_aux; False if q_ddot is not n numbers or a torque not finite."""
    n = tau.size
    if q_ddot.size != n:
        return False
    total = 0.0
    for i in range(n):
        torque = tau_aux[i]
        for j in range(n):
            torque += M[i, j] * q_ddot[j]
        tau[i] = torque
        total += torque
    return total - total == 0.0
