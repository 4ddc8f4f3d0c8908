"""Poses along a Cartesian path, compiled."""

from math import cos, sin, sqrt

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import Vector, add, dot, row_of, scale, subtract
from robots_core.validation import Array
from robots_planning.timing.quintic import interval_at

# Below this angle (rad) the power series is exact to rounding, the closed form is not.
SMALL_ANGLE = 0.05
STANDSTILL = 1e-12  # m and rad per unit of s; at rest the path has no direction

PathArrays = tuple[Array, Array, Array, Array, Array, Array]
"""Pieces of a path, x = s - breaks[i] in piece i: breaks (m + 1,); position polynomial (m, 6, 3) in powers of
x; arc (m, 2, 3), added as cos(rate x) arc[0] + sin(rate x) arc[1]; rate (m,); rotation vector (m, 4, 3) in
powers of x, base frame; T (m, 3, 3), which that rotation turns."""


@compiled(counted=False)
def pose_on_path(path: PathArrays, s: float, r: Array, T: Array, x_s: Array, x_ss: Array) -> None:  # noqa: PLR0917
    """Fill r (3,), T (3, 3), and x' and x'' (6,): linear, then angular, base frame, per unit of s."""
    breaks, position, arc, rate, turn, orientation = path
    i = interval_at(breaks, s)
    x = s - breaks[i]
    angle = rate[i] * x
    c, sn = cos(angle), sin(angle)
    for k in range(3):
        a0, a1, a2 = position[i, 0, k], position[i, 1, k], position[i, 2, k]
        a3, a4, a5 = position[i, 3, k], position[i, 4, k], position[i, 5, k]
        u, v, w = arc[i, 0, k], arc[i, 1, k], rate[i]
        r[k] = a0 + x * (a1 + x * (a2 + x * (a3 + x * (a4 + x * a5)))) + c * u + sn * v
        x_s[k] = a1 + x * (2.0 * a2 + x * (3.0 * a3 + x * (4.0 * a4 + x * 5.0 * a5))) + w * (c * v - sn * u)
        x_ss[k] = 2.0 * a2 + x * (6.0 * a3 + x * (12.0 * a4 + x * 20.0 * a5)) - w * w * (c * u + sn * v)
    b0, b1, b2, b3 = row_of(turn[i], 0), row_of(turn[i], 1), row_of(turn[i], 2), row_of(turn[i], 3)
    p = add(b0, scale(x, add(b1, scale(x, add(b2, scale(x, b3))))))
    p1 = add(b1, scale(x, add(scale(2.0, b2), scale(3.0 * x, b3))))
    p2 = add(scale(2.0, b2), scale(6.0 * x, b3))
    _turned(p, p1, p2, orientation[i], T, x_s, x_ss)


@compiled(counted=False)
def _turned(  # noqa: PLR0917
    p: Vector, p1: Vector, p2: Vector, T0: Array, T: Array, x_s: Array, x_ss: Array
) -> None:
    """Fill T = exp([p]) T0, its angular velocity and acceleration.

    omega = p' + A p x p' + B p x (p x p'), A = (1 - cos a) / a^2, B = (a - sin a) / a^3, a = |p|: the left
    Jacobian of the rotation group (Chirikjian 2012, 10.86).
    """
    square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2]
    if square < SMALL_ANGLE * SMALL_ANGLE:
        S = 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
        A = 0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0))
        B = 1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))
        # Derivatives with respect to the angle, over the angle.
        dA = -1.0 / 12.0 + square / 180.0 * (1.0 - 3.0 * square / 112.0)
        dB = -1.0 / 60.0 + square / 1260.0 * (1.0 - square / 48.0)
    else:
        angle = sqrt(square)
        c, sn = cos(angle), sin(angle)
        S = sn / angle
        A = (1.0 - c) / square
        B = (angle - sn) / (square * angle)
        dA = (sn / angle - 2.0 * A) / square
        dB = ((1.0 - c) / square - 3.0 * B) / square
    # exp([p]) = I + S [p] + A [p]^2
    for j in range(3):
        x, y, z = T0[0, j], T0[1, j], T0[2, j]
        cx, cy, cz = p[1] * z - p[2] * y, p[2] * x - p[0] * z, p[0] * y - p[1] * x
        T[0, j] = x + S * cx + A * (p[1] * cz - p[2] * cy)
        T[1, j] = y + S * cy + A * (p[2] * cx - p[0] * cz)
        T[2, j] = z + S * cz + A * (p[0] * cy - p[1] * cx)
    rate = p[0] * p1[0] + p[1] * p1[1] + p[2] * p1[2]
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        cross = p[m] * p1[n] - p[n] * p1[m]
        # p x (p x p') = p (p . p') - p' |p|^2
        double = p[k] * rate - p1[k] * square
        further = p[m] * p2[n] - p[n] * p2[m]
        # p' x (p x p') + p x (p x p'')
        second = (
            p[k] * (p1[0] * p1[0] + p1[1] * p1[1] + p1[2] * p1[2])
            - p1[k] * rate
            + p[k] * (p[0] * p2[0] + p[1] * p2[1] + p[2] * p2[2])
            - p2[k] * square
        )
        x_s[3 + k] = p1[k] + A * cross + B * double
        x_ss[3 + k] = p2[k] + dA * rate * cross + A * further + dB * rate * double + B * second


@compiled(counted=False)
def poses_on_path(path: PathArrays, s: Array, r: Array, T: Array, x_s: Array, x_ss: Array) -> None:  # noqa: PLR0917
    """`pose_on_path` for every s (m,): fill (m, 3), (m, 3, 3), (m, 6), (m, 6)."""
    for i in range(s.size):
        pose_on_path(path, s[i], r[i], T[i], x_s[i], x_ss[i])


@compiled()
def travel(x_s: Array, x_ss: Array) -> tuple[Array, Array, Array]:
    """Rates of arc length and angle over s, their derivatives, and the normal parts of x'', (m, 2) each.

    With x' = |x'| t: |x'|' = t x'', and across the path x'' - (t x'') t.

    Args:
        x_s: First derivative of the tool's pose, (m, 6): linear, then angular.
        x_ss: Second derivative, (m, 6).
    """
    m = len(x_s)
    rate, along, across = np.zeros((m, 2)), np.zeros((m, 2)), np.zeros((m, 2))
    for i in range(m):
        for part in range(2):
            x, y, z = 3 * part, 3 * part + 1, 3 * part + 2
            first, second = (x_s[i, x], x_s[i, y], x_s[i, z]), (x_ss[i, x], x_ss[i, y], x_ss[i, z])
            rate[i, part] = sqrt(dot(first, first))
            if rate[i, part] > STANDSTILL:
                along[i, part] = dot(first, second) / rate[i, part]
                second = subtract(second, scale(along[i, part] / rate[i, part], first))
            across[i, part] = sqrt(dot(second, second))
    return rate, along, across
