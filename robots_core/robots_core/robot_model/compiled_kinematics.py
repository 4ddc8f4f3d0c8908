"""Direct kinematics of a serial chain, compiled: less than Pinocchio's call and reading its result."""

from __future__ import annotations

from math import cos, sin

import numba as nb

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

_Links = nb.float64[:, ::1]
# Exactly what most callers have is found fastest; the second takes all other arrays of numbers like these.
_SIGNATURES = tuple(
    nb.boolean(_Links, positions, nb.float64[::1], nb.float64[:, ::1])
    for positions in (nb.float64[::1], nb.types.Array(nb.float64, 1, 'A', readonly=True))
)


@compiled(*_SIGNATURES)
def tool_pose(links: Array, q: Array, r: Array, T: Array) -> bool:
    """Fill position r (3,) and orientation T (3, 3) of the tool at q; False if q is not n finite numbers."""
    n = q.size
    if n != links.shape[0] - 1:
        return False
    total = 0.0
    R00, R01, R02, R10, R11, R12, R20, R21, R22 = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    x, y, z = 0.0, 0.0, 0.0
    for i in range(n + 1):
        a, b, c = links[i, 9], links[i, 10], links[i, 11]
        x += R00 * a + R01 * b + R02 * c
        y += R10 * a + R11 * b + R12 * c
        z += R20 * a + R21 * b + R22 * c
        E00, E01, E02 = links[i, 0], links[i, 1], links[i, 2]
        E10, E11, E12 = links[i, 3], links[i, 4], links[i, 5]
        E20, E21, E22 = links[i, 6], links[i, 7], links[i, 8]
        R00, R01, R02 = (
            R00 * E00 + R01 * E10 + R02 * E20,
            R00 * E01 + R01 * E11 + R02 * E21,
            R00 * E02 + R01 * E12 + R02 * E22,
        )
        R10, R11, R12 = (
            R10 * E00 + R11 * E10 + R12 * E20,
            R10 * E01 + R11 * E11 + R12 * E21,
            R10 * E02 + R11 * E12 + R12 * E22,
        )
        R20, R21, R22 = (
            R20 * E00 + R21 * E10 + R22 * E20,
            R20 * E01 + R21 * E11 + R22 * E21,
            R20 * E02 + R21 * E12 + R22 * E22,
        )
        if i == n:
            break
        total += q[i]
        if links[i, 12] != 0.0:
            x, y, z = x + R02 * q[i], y + R12 * q[i], z + R22 * q[i]
            continue
        c, s = cos(q[i]), sin(q[i])
        R00, R01 = c * R00 + s * R01, c * R01 - s * R00
        R10, R11 = c * R10 + s * R11, c * R11 - s * R10
        R20, R21 = c * R20 + s * R21, c * R21 - s * R20
    r[0], r[1], r[2] = x, y, z
    T[0, 0], T[0, 1], T[0, 2] = R00, R01, R02
    T[1, 0], T[1, 1], T[1, 2] = R10, R11, R12
    T[2, 0], T[2, 1], T[2, 2] = R20, R21, R22
    return total - total == 0.0
