"""Direct kinematics of a serial chain, compiled: faster than calling Pinocchio."""

from math import cos, sin

import numba as nb

from robots_core.robot_model.analytic.compiled import compiled, entry_point
from robots_core.robot_model.analytic.vectors import Matrix, Vector, add, product, times
from robots_core.validation import Array

_Rows = nb.float64[:, ::1]
_Vector = nb.float64[::1]
# One signature for all arrays of numbers: Numba selects it faster than one of several.
_Numbers = nb.types.Array(nb.float64, 1, 'A', readonly=True)


@compiled()
def _turned_about_z(R: Matrix, angle: float) -> Matrix:
    """R Rot(z, angle), without the product's zeros."""
    c, s = cos(angle), sin(angle)
    (a, b, z), (d, e, y), (g, h, x) = R
    return (
        (c * a + s * b, c * b - s * a, z),
        (c * d + s * e, c * e - s * d, y),
        (c * g + s * h, c * h - s * g, x),
    )


@compiled()
def _link(links: Array, i: int) -> tuple[Matrix, Vector]:
    """Rotation and translation of a row of `links_of`."""
    return (
        (links[i, 0], links[i, 1], links[i, 2]),
        (links[i, 3], links[i, 4], links[i, 5]),
        (links[i, 6], links[i, 7], links[i, 8]),
    ), (links[i, 9], links[i, 10], links[i, 11])


@compiled(nb.boolean(_Rows, _Numbers, _Vector, _Rows), nogil=False, nrt=False)
def _tool_pose(links: Array, q: Array, r: Array, T: Array) -> bool:
    """Fill position r (3,) and orientation T (3, 3) of the tool at q; False if q is not n finite numbers."""
    n = q.size
    if n != links.shape[0] - 1:
        return False
    total = 0.0
    R, t = _link(links, 0)
    for i in range(n):
        total += q[i]
        if links[i, 12] != 0.0:
            t = add(t, times(R, (0.0, 0.0, q[i])))
        else:
            R = _turned_about_z(R, q[i])
        turn, step = _link(links, i + 1)
        t = add(t, times(R, step))
        R = product(R, turn)
    r[0], r[1], r[2] = t
    for row in range(3):
        T[row, 0], T[row, 1], T[row, 2] = R[row]
    return total - total == 0.0


# Called several times per sample; half of a call is Numba's inspection of the argument types.
tool_pose = entry_point(_tool_pose)
