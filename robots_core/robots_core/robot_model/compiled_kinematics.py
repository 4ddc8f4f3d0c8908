"""Direct kinematics of a serial chain, compiled: faster than calling Pinocchio."""

from robots_core.kernels.compiled import compiled
from robots_core.kernels.loaded_numba import nb
from robots_core.kernels.serial_chain import ChainArrays, next_frame
from robots_core.validation import Array

_Rows = nb.float64[:, ::1]
# One signature for all arrays of numbers: Numba selects it faster than one of several.
_Numbers = nb.types.Array(nb.float64, 1, 'A', readonly=True)


@compiled(nb.boolean(_Rows, _Numbers, nb.float64[::1], _Rows), nogil=False)
def tool_pose(chain: ChainArrays, q: Array, r: Array, T: Array) -> bool:
    """Fill position r (3,) and orientation T (3, 3) of the tool at q; False if q is not n finite numbers."""
    n = q.size
    if n != chain.shape[0] - 1:
        return False
    total = 0.0
    R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
    for i in range(n):
        total += q[i]
        _, R, t = next_frame(chain, i, q[i], R, t)
    tip, R, _ = next_frame(chain, n, 0.0, R, t)
    r[0], r[1], r[2] = tip
    for row in range(3):
        T[row, 0], T[row, 1], T[row, 2] = R[row]
    return total - total == 0.0


@compiled()
def tool_poses(chain: ChainArrays, q: Array, r: Array, T: Array) -> bool:
    """Fill positions r (m, 3) and orientations T (m, 3, 3) at q (m, n); False as `tool_pose`."""
    finite = True
    for row in range(q.shape[0]):
        finite = tool_pose(chain, q[row], r[row], T[row]) and finite
    return finite
