"""The closed forms of shoulder, elbow and wrist, compiled: one joint's triangle each, and its frames.

Every angle is computed from sine and cosine together, which keeps full accuracy in and near singularities:
the arc cosine of textbooks is accurate to 1e-8 only where an arm is stretched or a wrist straight.
"""

from math import atan2, hypot, sqrt
from typing import Any

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.vectors import (
    Matrix,
    Vector,
    add,
    cross,
    dot,
    matrix_of,
    scale,
    subtract,
    times,
    transposed,
    vector_of,
)
from robots_core.validation import Array

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
def wrist_roll(arm: Any, u: Vector, t: Vector, c: float, s: float) -> float:
    """Angle of axis 6 for its direction u, the mark's direction t and the first axis' cosine and sine."""
    first = (arm.sin_a * c, arm.sin_a * s, arm.cos_a)
    return atan2(dot(first, cross(t, u)), dot(first, t))


@compiled()
def shoulder_turn(arm: Any, v: Vector) -> tuple[int, float, float]:
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
def _turned(T: Matrix, x: Vector) -> Vector:
    """R x, with R one step from T towards the nearest rotation, (3 T - T T^T T) / 2.

    Poses from messages carry single-precision rounding.
    """
    y = times(T, x)
    back = times(T, times(transposed(T), y))
    return subtract(scale(1.5, y), scale(0.5, back))


@compiled()
def seen_from_axis_1(arm: Any, r: Array, T: Array) -> tuple[Vector, Vector, Vector]:
    """Wrist point, direction of axis 6 and mark of a pose, in the frame of axis 1 before it turns."""
    basis, turn = matrix_of(arm.basis), matrix_of(T)
    v = add(subtract(vector_of(r), vector_of(arm.origin)), _turned(turn, vector_of(arm.wrist_point)))
    u, t = _turned(turn, vector_of(arm.last_axis)), _turned(turn, vector_of(arm.mark))
    return times(basis, v), times(basis, u), times(basis, t)


@compiled()
def seen_from_body_1(arm: Any, v: Vector, c: float, s: float) -> Vector:
    """[X, Y, Z] of body 1 for a vector in the frame of axis 1, which has turned by cosine c and sine s."""
    a, b = v[0] * c + v[1] * s, v[1] * c - v[0] * s
    return b, arm.tilt_cos * v[2] - arm.tilt_sin * a, arm.tilt_cos * a + arm.tilt_sin * v[2]


@compiled()
def seen_from_wrist(arm: Any, v: Vector, c: float, s: float) -> Vector:
    """Wrist coordinates of a vector in [X, Y, Z], the wrist's carrier being turned by c and s about Z."""
    return times(matrix_of(arm.wrist_basis), (v[0] * c + v[1] * s, v[1] * c - v[0] * s, v[2]))


@compiled()
def unusable(r: Array, T: Array, tolerance: float) -> bool:
    """Whether r and T are of another shape, not finite, or T is no rotation within the tolerance."""
    if r.shape[0] != 3 or T.shape[0] != 3 or T.shape[1] != 3:
        return True
    rows = matrix_of(T)
    for i in range(3):
        if not abs(r[i]) < np.inf:
            return True
        for j in range(i + 1):
            # Written so that NaN is unusable.
            if not abs(dot(rows[i], rows[j]) - (1.0 if i == j else 0.0)) <= tolerance:
                return True
    return bool(dot(rows[0], cross(rows[1], rows[2])) < 0.0)
