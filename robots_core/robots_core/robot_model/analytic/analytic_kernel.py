"""All solutions of an arm, compiled: loops over the branches of the closed forms, per family of arms."""

# Compiled code takes positional arguments.
# ruff: noqa: PLR0917
from math import atan2, cos, floor, hypot, pi, sin
from typing import Any

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.loaded_numba import nb
from robots_core.kernels.vectors import Vector
from robots_core.robot_model.analytic.arm_record import ARM
from robots_core.robot_model.analytic.closed_forms import (
    FREE,
    ONE,
    TWO,
    UNREACHABLE,
    elbow_bend,
    seen_from_axis_1,
    seen_from_body_1,
    seen_from_wrist,
    shoulder_turn,
    unusable,
    upper_arm,
    wrist_bend,
    wrist_roll,
    wrist_swing,
)
from robots_core.validation import Array

TAU = 2.0 * pi
INVALID = -1
WORK = 8  # behind the eight rows of solutions, the row in which a solution grows, axis by axis
LIMIT_ROUNDING = 1e-10  # rad; solutions past a limit by rounding are put on it
# Tries of free angles if the first gives no solution inside the limits. The free angle of the wrist advances
# by the golden section, so that all pairs of a free shoulder and a free wrist are covered evenly.
FREE_TRIES = 64
FREE_STEP = TAU / FREE_TRIES
GOLDEN_STEP = TAU * 0.6180339887498949

_arm = nb.from_dtype(ARM)
_vector = nb.types.Array(nb.float64, 1, 'A', readonly=True)
_matrix = nb.types.Array(nb.float64, 2, 'A', readonly=True)
_signature = nb.int64(
    nb.types.Array(_arm, 1, 'C', readonly=True), _vector, _matrix, _vector, nb.float64[:, ::1]
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
    v: Vector, solutions: int, branch: int, along: float, across: float, free: float
) -> tuple[float, float]:
    """Cosine and sine of axis 1 in one of its solutions."""
    if solutions == FREE:
        c, s = cos(free), sin(free)
        return (c, s) if branch == 0 else (-c, -s)
    w = across if branch == 0 else -across
    c, s = v[0] * along - v[1] * w, v[1] * along + v[0] * w
    scale = 1.0 / hypot(c, s)
    return c * scale, s * scale


@compiled()
def _wrists(
    arm: Any, u: Vector, t: Vector, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 4, 5 and 6 of a spherical wrist, for the arm angles in the working row."""
    solutions, cosine, sine = wrist_bend(arm, u[0], u[1], u[2])
    angle = atan2(sine, cosine)
    for flip in range(0 if solutions == UNREACHABLE else 2 if solutions == TWO else 1):
        sign = 1.0 - 2.0 * flip
        if not _place(arm, near, found, 4, sign * angle - arm.straight):
            continue
        if solutions == FREE:
            free = near[3] + try_ * GOLDEN_STEP
            c, s = cos(free), sin(free)
        else:
            c, s = wrist_swing(arm, u[0], u[1], cosine, sign * sine)
        if _place(arm, near, found, 3, atan2(s, c)) and _place(
            arm, near, found, 5, wrist_roll(arm, u, t, c, s)
        ):
            count = _keep(found, count)
    return count, solutions == FREE


@compiled()
def _elbows_and_wrists(
    arm: Any, v: Vector, u: Vector, t: Vector, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 2 to 6 of an arm with a spherical wrist; all vectors in body 1."""
    x, y = v[0] - arm.shoulder[0], v[1] - arm.shoulder[1]
    solutions, cosine, sine = elbow_bend(arm, x, y)
    any_free = solutions == FREE
    angle, scale = atan2(sine, cosine), 1.0 / hypot(sine, cosine)
    for up in range(0 if solutions == UNREACHABLE else 2 if solutions == TWO else 1):
        sign = 1.0 - 2.0 * up
        bend = sign * angle - arm.forearm_angle + arm.upper_arm_angle
        if not _place(arm, near, found, 2, arm.sign_3 * bend):
            continue
        if solutions == FREE:
            free = near[1] + try_ * FREE_STEP + arm.upper_arm_angle
            c, s = cos(free), sin(free)
        else:
            c, s = upper_arm(arm, x, y, cosine, sign * sine)
        if not _place(arm, near, found, 1, atan2(s, c) - arm.upper_arm_angle):
            continue
        c3, s3 = cosine * scale, sign * sine * scale
        c, s = c * c3 - s * s3, s * c3 + c * s3
        wrist_u, wrist_t = seen_from_wrist(arm, u, c, s), seen_from_wrist(arm, t, c, s)
        count, free_wrist = _wrists(arm, wrist_u, wrist_t, near, found, count, try_)
        any_free = any_free or free_wrist
    return count, any_free


@compiled()
def _elbows(
    arm: Any, v: Vector, c: float, s: float, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 2, 3 and 4 of an arm with parallel axes, whose sum has cosine c and sine s; `v` in body 1."""
    # Axis 4 is where the hand, turned by the three axes together, puts it.
    x = v[0] - arm.shoulder[0] - (c * arm.hand[0] - s * arm.hand[1])
    y = v[1] - arm.shoulder[1] - (s * arm.hand[0] + c * arm.hand[1])
    solutions, cosine, sine = elbow_bend(arm, x, y)
    angle, total = atan2(sine, cosine), atan2(s, c)
    for up in range(0 if solutions == UNREACHABLE else 2 if solutions == TWO else 1):
        sign = 1.0 - 2.0 * up
        bend = sign * angle - arm.forearm_angle + arm.upper_arm_angle
        if solutions == FREE:
            raised = near[1] + try_ * FREE_STEP
        else:
            raised_c, raised_s = upper_arm(arm, x, y, cosine, sign * sine)
            raised = atan2(raised_s, raised_c) - arm.upper_arm_angle
        if (
            _place(arm, near, found, 2, arm.sign_3 * bend)
            and _place(arm, near, found, 1, raised)
            and _place(arm, near, found, 3, arm.sign_4 * (total - raised - bend))
        ):
            count = _keep(found, count)
    return count, solutions == FREE


@compiled()
def _hands_and_elbows(
    arm: Any, v: Vector, u: Vector, t: Vector, near: Array, found: Array, count: int, try_: int
) -> tuple[int, bool]:
    """Axes 2 to 6 of an arm with parallel axes; all vectors in body 1."""
    wrist_u, wrist_t = seen_from_wrist(arm, u, 1.0, 0.0), seen_from_wrist(arm, t, 1.0, 0.0)
    solutions, cosine, sine = wrist_bend(arm, wrist_u[0], wrist_u[1], wrist_u[2])
    any_free = solutions == FREE
    angle = atan2(sine, cosine)
    for flip in range(0 if solutions == UNREACHABLE else 2 if solutions == TWO else 1):
        sign = 1.0 - 2.0 * flip
        if not _place(arm, near, found, 4, sign * angle - arm.straight):
            continue
        if solutions == FREE:
            free = near[1] + arm.sign_3 * near[2] + arm.sign_4 * near[3] + try_ * GOLDEN_STEP
            c, s = cos(free), sin(free)
        else:
            c, s = wrist_swing(arm, wrist_u[0], wrist_u[1], cosine, sign * sine)
        if _place(arm, near, found, 5, wrist_roll(arm, wrist_u, wrist_t, c, s)):
            count, free_elbow = _elbows(arm, v, c, s, near, found, count, try_)
            any_free = any_free or free_elbow
    return count, any_free


@compiled(_signature, nogil=False)
def solve(arms: Any, r: Array, T: Array, near: Array, found: Array) -> int:
    """All solutions: the branches of axis 1, and of the axes behind it as the family of arms has them.

    Args:
        arms: Record array (1,) of `ARM`.
        r: Position of tool0, (3,), m.
        T: Orientation of tool0, (3, 3).
        near: Joint positions inside the limits, (6,), for full turns and free angles.
        found: Filled, (9, 6); the last row is scratch.

    Returns:
        Number of rows filled, or INVALID for an invalid pose.
    """
    if unusable(r, T, arms[0].rotation_tolerance):
        return INVALID
    arm = arms[0]
    v, u, t = seen_from_axis_1(arm, r, T)
    solutions, along, across = shoulder_turn(arm, v)
    branches = 0 if solutions == UNREACHABLE else 1 if solutions == ONE else 2
    count = 0
    for try_ in range(FREE_TRIES):
        any_free = solutions == FREE
        for branch in range(branches):
            c, s = _axis_1(v, solutions, branch, along, across, near[0] + try_ * FREE_STEP)
            if not _place(arm, near, found, 0, atan2(s, c)):
                continue
            point = seen_from_body_1(arm, v, c, s)
            body_u, body_t = seen_from_body_1(arm, u, c, s), seen_from_body_1(arm, t, c, s)
            if arm.parallel:
                count, free = _hands_and_elbows(arm, point, body_u, body_t, near, found, count, try_)
            else:
                count, free = _elbows_and_wrists(arm, point, body_u, body_t, near, found, count, try_)
            any_free = any_free or free
        if count > 0 or not any_free:
            break
    return count
