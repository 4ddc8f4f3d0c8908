"""The closed forms, compiled: shoulder, elbow and wrist, and one loop over their branches per family of arms.

Every angle comes from sine and cosine together, so that poses at and beside singularities lose no digits:
the arc cosine of the textbook is good to 1e-8 only where an arm is stretched or a wrist straight.
All compiled code stands in this one file: the cache of machine code looks at no other for changes.
"""

# Arguments stand by position: that is how compiled code takes them.
# ruff: noqa: PLR0917
from __future__ import annotations

from math import atan2, cos, floor, hypot, pi, sin, sqrt
from typing import Any

import numba
import numpy as np

from robots_core.robot_model.analytic.arm_record import ARM
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array

Triple = tuple[float, float, float]

TAU = 2.0 * pi
INVALID = -1
# How many postures there are; FREE: any angle will do.
UNREACHABLE, ONE, TWO, FREE = 0, 1, 2, 3
WORK = 8  # behind the eight rows of solutions, the row in which a solution grows, axis by axis
LIMIT_ROUNDING = 1e-10  # rad; solutions past a limit by rounding are put on it
# Tries of free angles where the first leaves no solution inside the limits. The free angle of the wrist goes
# on by the golden section, so that all pairs of a free shoulder and a free wrist are covered evenly.
FREE_TRIES = 64
FREE_STEP = TAU / FREE_TRIES
GOLDEN_STEP = TAU * 0.6180339887498949

_arm = numba.from_dtype(ARM)
_vector = numba.types.Array(numba.float64, 1, 'A', readonly=True)
_matrix = numba.types.Array(numba.float64, 2, 'A', readonly=True)
_signature = numba.int64(
    numba.types.Array(_arm, 1, 'C', readonly=True), _vector, _matrix, _vector, numba.float64[:, ::1]
)


@compiled()
def _turned_near(angle: float, near: float, lower: float, upper: float) -> float:
    """`angle` with full turns added: inside the limits and nearest to `near`, which is inside; else NaN."""
    q = angle + TAU * floor((near - angle) / TAU + 0.5)
    if q > upper + LIMIT_ROUNDING:
        q -= TAU
    elif q < lower - LIMIT_ROUNDING:
        q += TAU
    if q > upper:
        return upper if q <= upper + LIMIT_ROUNDING else np.nan
    if q < lower:
        return lower if q >= lower - LIMIT_ROUNDING else np.nan
    return q


@compiled()
def _wrist_bend(arm: Any, x: float, y: float, z: float) -> tuple[int, float, float]:
    """Bend of a wrist that brings its last axis to the direction (x, y, z), wrist basis.

    The spherical law of cosines with sides a, b and the angle psi between (x, y, z) and the first axis:
    cos psi = cos a cos b + sin a sin b cos C; the sine of C by the Gram determinant of the three axes.

    Returns:
        Number of postures (or FREE: the first axis may turn at will), cosine and sine >= 0 of C.
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
def _wrist_swing(arm: Any, x: float, y: float, cosine: float, sine: float) -> tuple[float, float]:
    """Cosine and sine of the first axis of the wrist, for its bend and the direction of its last axis."""
    reached_x = arm.cos_b * arm.sin_a - arm.sin_b * cosine * arm.cos_a
    reached_y = -arm.sin_b * sine
    along = x * reached_x + y * reached_y
    across = y * reached_x - x * reached_y
    scale = 1.0 / hypot(along, across)
    return along * scale, across * scale


@compiled()
def _wrist_roll(arm: Any, u: Triple, t: Triple, c: float, s: float) -> float:
    """Angle of axis 6 for its direction u, the mark's direction t and the first axis' cosine and sine."""
    kx, ky, kz = arm.sin_a * c, arm.sin_a * s, arm.cos_a
    cx = t[1] * u[2] - t[2] * u[1]
    cy = t[2] * u[0] - t[0] * u[2]
    cz = t[0] * u[1] - t[1] * u[0]
    return atan2(kx * cx + ky * cy + kz * cz, kx * t[0] + ky * t[1] + kz * t[2])


@compiled()
def _shoulder_turn(arm: Any, v: Triple) -> tuple[int, float, float]:
    """Axis 1: the wrist point keeps its offset along axis 2.

    Returns:
        Number of postures (or FREE), and coordinates of the wrist point along a and, apart from the sign,
        along b once axis 1 has turned.
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
def _elbow_bend(arm: Any, x: float, y: float) -> tuple[int, float, float]:
    """Axis 3: the triangle of upper arm, forearm and the way (x, y) from axis 2 to what they carry.

    Returns:
        Number of postures (or FREE: axis 2 may turn at will), and the products of both lengths with cosine
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
def _upper_arm(arm: Any, x: float, y: float, cosine: float, sine: float) -> tuple[float, float]:
    """Cosine and sine of the upper arm's direction, for an elbow as of `_elbow_bend`."""
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
def _seen_from_axis_1(arm: Any, r: Array, T: Array) -> tuple[Triple, Triple, Triple]:
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
def _seen_from_body_1(arm: Any, v: Triple, c: float, s: float) -> Triple:
    """[X, Y, Z] of body 1 for a vector in the frame of axis 1, which has turned by cosine c and sine s."""
    a, b = v[0] * c + v[1] * s, v[1] * c - v[0] * s
    return b, arm.tilt_cos * v[2] - arm.tilt_sin * a, arm.tilt_cos * a + arm.tilt_sin * v[2]


@compiled()
def _seen_from_wrist(arm: Any, v: Triple, c: float, s: float) -> Triple:
    """Wrist coordinates of a vector in [X, Y, Z], the wrist's carrier being turned by c and s about Z."""
    return _product(arm.wrist_basis, v[0] * c + v[1] * s, v[1] * c - v[0] * s, v[2])


@compiled()
def _unusable(r: Array, T: Array, tolerance: float) -> bool:
    if r.shape[0] != 3 or T.shape[0] != 3 or T.shape[1] != 3:
        return True
    for i in range(3):
        if not abs(r[i]) < np.inf:
            return True
        for j in range(i + 1):
            _product = T[i, 0] * T[j, 0] + T[i, 1] * T[j, 1] + T[i, 2] * T[j, 2]
            # Written so that NaN is unusable.
            if not abs(_product - (1.0 if i == j else 0.0)) <= tolerance:
                return True
    determinant = (
        T[0, 0] * (T[1, 1] * T[2, 2] - T[1, 2] * T[2, 1])
        - T[0, 1] * (T[1, 0] * T[2, 2] - T[1, 2] * T[2, 0])
        + T[0, 2] * (T[1, 0] * T[2, 1] - T[1, 1] * T[2, 0])
    )
    return bool(determinant < 0.0)


@compiled()
def _place(arm: Any, near: Array, found: Array, axis: int, angle: float) -> bool:
    """Enter the angle of an axis, counted from 0, if it can be turned inside the limits."""
    q = _turned_near(angle, near[axis], arm.lower[axis], arm.upper[axis])
    found[WORK, axis] = q
    return not np.isnan(q)


@compiled()
def _keep(found: Array, count: int) -> int:
    for axis in range(6):
        found[count, axis] = found[WORK, axis]
    return count + 1


@compiled()
def _axis_1(
    v: Triple, postures: int, branch: int, along: float, across: float, free: float
) -> tuple[float, float]:
    """Cosine and sine of axis 1 in one of its postures."""
    if postures == FREE:
        c, s = cos(free), sin(free)
        return (c, s) if branch == 0 else (-c, -s)
    w = across if branch == 0 else -across
    c, s = v[0] * along - v[1] * w, v[1] * along + v[0] * w
    scale = 1.0 / hypot(c, s)
    return c * scale, s * scale


@compiled()
def _wrists(
    arm: Any, u: Triple, t: Triple, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 4, 5 and 6 of a spherical wrist, for the arm that stands in the working row."""
    postures, cosine, sine = _wrist_bend(arm, u[0], u[1], u[2])
    angle = atan2(sine, cosine)
    for flip in range(0 if postures == UNREACHABLE else 2 if postures == TWO else 1):
        sign = 1.0 - 2.0 * flip
        if not _place(arm, near, found, 4, sign * angle - arm.straight):
            continue
        if postures == FREE:
            free = near[3] + try_ * GOLDEN_STEP
            c, s = cos(free), sin(free)
        else:
            c, s = _wrist_swing(arm, u[0], u[1], cosine, sign * sine)
        if _place(arm, near, found, 3, atan2(s, c)) and _place(
            arm, near, found, 5, _wrist_roll(arm, u, t, c, s)
        ):
            count = _keep(found, count)
    return count, postures == FREE


@compiled()
def _elbows_and_wrists(
    arm: Any, v: Triple, u: Triple, t: Triple, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 2 to 6 of an arm with a spherical wrist; all vectors in body 1."""
    x, y = v[0] - arm.shoulder[0], v[1] - arm.shoulder[1]
    postures, cosine, sine = _elbow_bend(arm, x, y)
    any_free = postures == FREE
    angle, scale = atan2(sine, cosine), 1.0 / hypot(sine, cosine)
    for up in range(0 if postures == UNREACHABLE else 2 if postures == TWO else 1):
        sign = 1.0 - 2.0 * up
        bend = sign * angle - arm.forearm_angle + arm.upper_arm_angle
        if not _place(arm, near, found, 2, arm.sign_3 * bend):
            continue
        if postures == FREE:
            free = near[1] + try_ * FREE_STEP + arm.upper_arm_angle
            c, s = cos(free), sin(free)
        else:
            c, s = _upper_arm(arm, x, y, cosine, sign * sine)
        if not _place(arm, near, found, 1, atan2(s, c) - arm.upper_arm_angle):
            continue
        c3, s3 = cosine * scale, sign * sine * scale
        c, s = c * c3 - s * s3, s * c3 + c * s3
        wrist_u, wrist_t = _seen_from_wrist(arm, u, c, s), _seen_from_wrist(arm, t, c, s)
        count, free_wrist = _wrists(arm, wrist_u, wrist_t, near, found, count, try_)
        any_free = any_free or free_wrist
    return count, any_free


@compiled()
def _elbows(
    arm: Any, v: Triple, c: float, s: float, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 2, 3 and 4 of an arm with parallel axes, whose sum has cosine c and sine s; `v` in body 1."""
    # Axis 4 is where the hand, turned by the three axes together, puts it.
    x = v[0] - arm.shoulder[0] - (c * arm.hand[0] - s * arm.hand[1])
    y = v[1] - arm.shoulder[1] - (s * arm.hand[0] + c * arm.hand[1])
    postures, cosine, sine = _elbow_bend(arm, x, y)
    angle, total = atan2(sine, cosine), atan2(s, c)
    for up in range(0 if postures == UNREACHABLE else 2 if postures == TWO else 1):
        sign = 1.0 - 2.0 * up
        bend = sign * angle - arm.forearm_angle + arm.upper_arm_angle
        if postures == FREE:
            raised = near[1] + try_ * FREE_STEP
        else:
            raised_c, raised_s = _upper_arm(arm, x, y, cosine, sign * sine)
            raised = atan2(raised_s, raised_c) - arm.upper_arm_angle
        if (
            _place(arm, near, found, 2, arm.sign_3 * bend)
            and _place(arm, near, found, 1, raised)
            and _place(arm, near, found, 3, arm.sign_4 * (total - raised - bend))
        ):
            count = _keep(found, count)
    return count, postures == FREE


@compiled()
def _hands_and_elbows(
    arm: Any, v: Triple, u: Triple, t: Triple, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 2 to 6 of an arm with parallel axes; all vectors in body 1."""
    wrist_u, wrist_t = _seen_from_wrist(arm, u, 1.0, 0.0), _seen_from_wrist(arm, t, 1.0, 0.0)
    postures, cosine, sine = _wrist_bend(arm, wrist_u[0], wrist_u[1], wrist_u[2])
    any_free = postures == FREE
    angle = atan2(sine, cosine)
    for flip in range(0 if postures == UNREACHABLE else 2 if postures == TWO else 1):
        sign = 1.0 - 2.0 * flip
        if not _place(arm, near, found, 4, sign * angle - arm.straight):
            continue
        if postures == FREE:
            free = near[1] + arm.sign_3 * near[2] + arm.sign_4 * near[3] + try_ * GOLDEN_STEP
            c, s = cos(free), sin(free)
        else:
            c, s = _wrist_swing(arm, wrist_u[0], wrist_u[1], cosine, sign * sine)
        if _place(arm, near, found, 5, _wrist_roll(arm, wrist_u, wrist_t, c, s)):
            count, free_elbow = _elbows(arm, v, c, s, near, found, count, try_)
            any_free = any_free or free_elbow
    return count, any_free


@compiled(_signature)
def solve_spherical_wrist(arms: Any, r: Array, T: Array, near: Array, found: Array) -> int:
    """All postures of an arm with a spherical wrist.

    Args:
        arms: Record array (1,) of `ARM`.
        r: Position of tool0, (3,), m.
        T: Orientation of tool0, (3, 3).
        near: Posture inside the limits, (6,): full turns nearest to it, free angles from it.
        found: Filled, (9, 6); the last row is scratch.

    Returns:
        Number of rows filled, or INVALID for a pose that is none.
    """
    if _unusable(r, T, arms[0].rotation_tolerance):
        return INVALID
    arm = arms[0]
    v, u, t = _seen_from_axis_1(arm, r, T)
    postures, along, across = _shoulder_turn(arm, v)
    branches = 0 if postures == UNREACHABLE else 1 if postures == ONE else 2
    count = 0
    for try_ in range(FREE_TRIES):
        any_free = postures == FREE
        for branch in range(branches):
            c, s = _axis_1(v, postures, branch, along, across, near[0] + try_ * FREE_STEP)
            if not _place(arm, near, found, 0, atan2(s, c)):
                continue
            point = _seen_from_body_1(arm, v, c, s)
            body_u, body_t = _seen_from_body_1(arm, u, c, s), _seen_from_body_1(arm, t, c, s)
            count, free = _elbows_and_wrists(arm, point, body_u, body_t, near, found, count, try_)
            any_free = any_free or free
        if count > 0 or not any_free:
            break
    return count


@compiled(_signature)
def solve_parallel_axes(arms: Any, r: Array, T: Array, near: Array, found: Array) -> int:
    """All postures of an arm of the Universal Robots kind; as `solve_spherical_wrist`."""
    if _unusable(r, T, arms[0].rotation_tolerance):
        return INVALID
    arm = arms[0]
    v, u, t = _seen_from_axis_1(arm, r, T)
    postures, along, across = _shoulder_turn(arm, v)
    branches = 0 if postures == UNREACHABLE else 1 if postures == ONE else 2
    count = 0
    for try_ in range(FREE_TRIES):
        any_free = postures == FREE
        for branch in range(branches):
            c, s = _axis_1(v, postures, branch, along, across, near[0] + try_ * FREE_STEP)
            if not _place(arm, near, found, 0, atan2(s, c)):
                continue
            point = _seen_from_body_1(arm, v, c, s)
            body_u, body_t = _seen_from_body_1(arm, u, c, s), _seen_from_body_1(arm, t, c, s)
            count, free = _hands_and_elbows(arm, point, body_u, body_t, near, found, count, try_)
            any_free = any_free or free
        if count > 0 or not any_free:
            break
    return count
