"""The closed forms of shoulder, elbow and wrist, compiled: one joint's triangle each, and its frames.

Every angle is computed from sine and cosine together, which keeps full accuracy in and near singularities:
the arc cosine of textbooks is accurate to 1e-8 only where an arm is stretched or a wrist straight.
"""

from math import atan2, hypot, sqrt
from typing import Any

import numpy as np

from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

Triple = tuple[float, float, float]

# Number of solutions; FREE: any angle is a solution.
UNREACHABLE, ONE, TWO, FREE = 0, 1, 2, 3


@compiled()
def wrist_bend(arm: Any, x: float, y: float, z: float) -> tuple[int, float, float]:
    """Bend of a wrist that brings its last axis to the direction (x, y, z), wrist basis.

    The spherical law of cosines with sides a, b and the angle psi between (x, y, z) and the first axis:
    cos psi = cos a cos b + sin a sin b cos C; the sine of C by the Gram determinant of the three axes.

    Returns:
        Number of solutions (or FREE: any angle of the first axis), cosine and sine >= 0 of C.
    """
    ca, cb = arm.cos_a, arm.cos_b
    across_2 = x * x + y * y
    if z >= 0.0:
        square = across_2 - (ca - cb) ** 2 - 2.0 * ca * cb * across_2 / (1.0 + z)
    else:
        square = across_2 - (ca + cb) ** 2 + 2.0 * ca * cb * across_2 / (1.0 - z)
    cosine = z - ca * cb
    if square > 0.0 and across_2 > arm.slack * arm.slack:
        sine = sqrt(square)
        scale = 1.0 / hypot(sine, cosine)
        return TWO, cosine * scale, sine * scale
    across = sqrt(across_2)
    cosine = 1.0 if cosine >= 0.0 else -1.0
    reached_across = abs(cb * arm.sin_a - cosine * arm.sin_b * ca)
    reached_along = cb * ca + cosine * arm.sin_b * arm.sin_a
    if abs(across * reached_along - z * reached_across) > arm.slack or z * reached_along < 0.0:
        return UNREACHABLE, cosine, 0.0
    return (ONE if across > arm.slack else FREE), cosine, 0.0


@compiled()
def wrist_swing(arm: Any, x: float, y: float, cosine: float, sine: float) -> tuple[float, float]:
    """Cosine and sine of the first axis of the wrist, for its bend and the direction of its last axis."""
    reached_x = arm.cos_b * arm.sin_a - arm.sin_b * cosine * arm.cos_a
    reached_y = -arm.sin_b * sine
    along = x * reached_x + y * reached_y
    across = y * reached_x - x * reached_y
    scale = 1.0 / hypot(along, across)
    return along * scale, across * scale


@compiled()
def wrist_roll(arm: Any, u: Triple, t: Triple, c: float, s: float) -> float:
    """Angle of axis 6 for its direction u, the mark's direction t and the first axis' cosine and sine."""
    kx, ky, kz = arm.sin_a * c, arm.sin_a * s, arm.cos_a
    cx = t[1] * u[2] - t[2] * u[1]
    cy = t[2] * u[0] - t[0] * u[2]
    cz = t[0] * u[1] - t[1] * u[0]
    return atan2(kx * cx + ky * cy + kz * cz, kx * t[0] + ky * t[1] + kz * t[2])


@compiled()
def shoulder_turn(arm: Any, v: Triple) -> tuple[int, float, float]:
    """Axis 1: the wrist point keeps its offset along axis 2.

    Returns:
        Number of solutions (or FREE), and coordinates of the wrist point along a and, apart from the sign,
        along b after the rotation of axis 1.
    """
    radius = hypot(v[0], v[1])
    along = (arm.offset - arm.tilt_sin * v[2]) / arm.tilt_cos
    if radius <= arm.slack:
        return (FREE if abs(along) <= arm.slack else UNREACHABLE), along, 0.0
    if abs(along) >= radius:
        if abs(along) - radius > arm.slack:
            return UNREACHABLE, along, 0.0
        return ONE, (radius if along > 0.0 else -radius), 0.0
    return TWO, along, sqrt((radius - along) * (radius + along))


@compiled()
def elbow_bend(arm: Any, x: float, y: float) -> tuple[int, float, float]:
    """Axis 3: the triangle of upper arm, forearm and the vector (x, y) from axis 2 to their tip.

    Returns:
        Number of solutions (or FREE: any angle of axis 2), and the products of both lengths with cosine
        and sine >= 0 of the angle between them.
    """
    first, second = arm.upper_arm, arm.forearm
    distance = hypot(x, y)
    longest, shortest = first + second, abs(first - second)
    if distance >= longest:
        return (ONE if distance - longest <= arm.slack else UNREACHABLE), first * second, 0.0
    if distance <= shortest or distance <= arm.slack:
        if shortest - distance > arm.slack:
            return UNREACHABLE, -first * second, 0.0
        return (ONE if distance > arm.slack else FREE), -first * second, 0.0
    cosine = 0.5 * ((distance - first) * (distance + first) - second * second)
    sine = 0.5 * sqrt(
        (longest - distance) * (longest + distance) * (distance - shortest) * (distance + shortest)
    )
    return TWO, cosine, sine


@compiled()
def upper_arm(arm: Any, x: float, y: float, cosine: float, sine: float) -> tuple[float, float]:
    """Cosine and sine of the upper arm's direction, for an elbow as of `elbow_bend`."""
    zx = arm.upper_arm * arm.upper_arm + cosine
    along = x * zx + y * sine
    across = y * zx - x * sine
    scale = 1.0 / hypot(along, across)
    return along * scale, across * scale


@compiled()
def _product(M: Array, x: float, y: float, z: float) -> Triple:
    return (
        M[0, 0] * x + M[0, 1] * y + M[0, 2] * z,
        M[1, 0] * x + M[1, 1] * y + M[1, 2] * z,
        M[2, 0] * x + M[2, 1] * y + M[2, 2] * z,
    )


@compiled()
def seen_from_axis_1(arm: Any, r: Array, T: Array) -> tuple[Triple, Triple, Triple]:
    """Wrist point, direction of axis 6 and mark of a pose, in the frame of axis 1 before it turns."""
    # One step towards the nearest rotation: poses from messages carry single-precision rounding.
    R = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            R[i, j] = 1.5 * T[i, j]
            for k in range(3):
                gram = T[0, k] * T[0, j] + T[1, k] * T[1, j] + T[2, k] * T[2, j]
                R[i, j] -= 0.5 * T[i, k] * gram
    v, u, t = np.empty(3), np.empty(3), np.empty(3)
    for i in range(3):
        v[i] = r[i] - arm.origin[i]
        u[i] = t[i] = 0.0
        for j in range(3):
            v[i] += R[i, j] * arm.wrist_point[j]
            u[i] += R[i, j] * arm.last_axis[j]
            t[i] += R[i, j] * arm.mark[j]
    return (
        _product(arm.basis, v[0], v[1], v[2]),
        _product(arm.basis, u[0], u[1], u[2]),
        _product(arm.basis, t[0], t[1], t[2]),
    )


@compiled()
def seen_from_body_1(arm: Any, v: Triple, c: float, s: float) -> Triple:
    """[X, Y, Z] of body 1 for a vector in the frame of axis 1, which has turned by cosine c and sine s."""
    a, b = v[0] * c + v[1] * s, v[1] * c - v[0] * s
    return b, arm.tilt_cos * v[2] - arm.tilt_sin * a, arm.tilt_cos * a + arm.tilt_sin * v[2]


@compiled()
def seen_from_wrist(arm: Any, v: Triple, c: float, s: float) -> Triple:
    """Wrist coordinates of a vector in [X, Y, Z], the wrist's carrier being turned by c and s about Z."""
    return _product(arm.wrist_basis, v[0] * c + v[1] * s, v[1] * c - v[0] * s, v[2])


@compiled()
def unusable(r: Array, T: Array, tolerance: float) -> bool:
    """Whether r and T are of another shape, not finite, or T is no rotation within the tolerance."""
    if r.shape[0] != 3 or T.shape[0] != 3 or T.shape[1] != 3:
        return True
    for i in range(3):
        if not abs(r[i]) < np.inf:
            return True
        for j in range(i + 1):
            product = T[i, 0] * T[j, 0] + T[i, 1] * T[j, 1] + T[i, 2] * T[j, 2]
            # Written so that NaN is unusable.
            if not abs(product - (1.0 if i == j else 0.0)) <= tolerance:
                return True
    determinant = (
        T[0, 0] * (T[1, 1] * T[2, 2] - T[1, 2] * T[2, 1])
        - T[0, 1] * (T[1, 0] * T[2, 2] - T[1, 2] * T[2, 0])
        + T[0, 2] * (T[1, 0] * T[2, 1] - T[1, 1] * T[2, 0])
    )
    return bool(determinant < 0.0)
