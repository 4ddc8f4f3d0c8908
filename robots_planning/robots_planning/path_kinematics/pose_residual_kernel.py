"""A posture beside a path of the tool: how far off it is, its correction and derivatives, compiled."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from robots_core.blocks.inverse_kinematics.jacobian_derivative import jacobian_der
from robots_core.blocks.inverse_kinematics.serial_chain import ChainArrays, error_between, pose_and_jacobian
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.validation import Array
from robots_planning.path_kinematics.pseudo_inverse import (
    Scratch,
    apply_pseudo_inverse,
    multiply,
    multiply_transposed,
    pseudo_inverse,
    scratch_for,
)
from robots_planning.paths.cartesian_path_kernel import PathArrays, pose_on_path

CORRECTION_TOLERANCE = 1e-13  # m and rad; of the axes, that over the smallest singular value
CORRECTION_STEPS = 4
LARGEST_KNOT_MOTION = 0.25  # rad (m) of one axis from knot to knot; more may hide a change of configuration
LOST_MOTION = 1e-7  # part of the tool's motion along the path that may be missing in a singular posture


class View(NamedTuple):
    """A place of a path as seen from a posture beside it, and scratch memory.

    Attributes:
        r: Where the place is, (3,).
        T: Its orientation, (3, 3).
        x_s: The path's derivative over s there, (6,).
        x_ss: Its second derivative, (6,).
        r_now: Where the tool is, (3,).
        T_now: Its orientation, (3, 3).
        J: Geometric Jacobian, (6, n).
        error: From the tool to the place, (6,).
        J_s: Scratch, (6, n).
        P: Scratch, (n, 6).
        step: Scratch, (n,).
        rest: Scratch, (6,).
        twist: Scratch, (6,).
        solver: Scratch for decompositions.
    """

    r: Array
    T: Array
    x_s: Array
    x_ss: Array
    r_now: Array
    T_now: Array
    J: Array
    error: Array
    J_s: Array
    P: Array
    step: Array
    rest: Array
    twist: Array
    solver: Scratch


@compiled()
def view_of(n: int) -> View:
    """Memory for a robot of n axes, made once per path."""
    return View(
        np.empty(3), np.empty((3, 3)), np.empty(6), np.empty(6), np.empty(3), np.empty((3, 3)),
        np.empty((6, n)), np.empty(6), np.empty((6, n)), np.empty((n, 6)), np.empty(n), np.empty(6),
        np.empty(6), scratch_for(n),
    )  # fmt: skip


@compiled(nrt=False)
def aim_at(path: PathArrays, s: float, view: View) -> None:
    """Fill where the path is at `s`; what follows is about postures beside that place."""
    pose_on_path(path, s, view.r, view.T, view.x_s, view.x_ss)


@compiled(nrt=False)
def look_from(chain: ChainArrays, q: Array, view: View) -> float:
    """Fill what is known of posture `q`, (n,); the largest entry of its error."""
    pose_and_jacobian(chain, q, view.r_now, view.T_now, view.J)
    error_between(view.r_now, view.T_now, view.r, view.T, view.error)
    largest = 0.0
    for k in range(6):
        largest = max(largest, abs(view.error[k]))
    return largest


@compiled(nrt=False)
def correct(chain: ChainArrays, q: Array, view: View) -> bool:
    """Newton's method from a close guess, in place; False if it does not converge in a few steps.

    The view is then that from the corrected posture.
    """
    error = look_from(chain, q, view)
    for _ in range(CORRECTION_STEPS):
        if error < CORRECTION_TOLERANCE:
            break
        apply_pseudo_inverse(view.J, view.error, view.step, view.solver)
        for k in range(q.size):
            if not abs(view.step[k]) <= LARGEST_KNOT_MOTION:
                return False
        for k in range(q.size):
            q[k] += view.step[k]
        error = look_from(chain, q, view)
    return error < CORRECTION_TOLERANCE


@compiled(nrt=False)
def derivatives(view: View, q_s: Array, q_ss: Array) -> bool:
    """Fill q' = J^+ x' and q'' = d/ds (J^+ x'), (n,), of the posture in view; False if it cannot move so."""
    n = q_s.size
    x_s, J, P, J_s, rest = view.x_s, view.J, view.P, view.J_s, view.rest
    if n > 6:  # which needs the pseudo-inverse itself
        pseudo_inverse(J, P, view.solver)
        multiply(P, x_s, q_s)
    else:
        apply_pseudo_inverse(J, x_s, q_s, view.solver)
    multiply(J, q_s, rest)
    missing, whole = 0.0, 0.0
    for k in range(6):
        missing += (x_s[k] - rest[k]) ** 2
        whole += x_s[k] ** 2
    if not sqrt(missing) <= LOST_MOTION * sqrt(whole):
        return False
    jacobian_der(J, q_s, J_s)
    multiply(J_s, q_s, rest)
    for k in range(6):
        rest[k] = view.x_ss[k] - rest[k]
    # Golub and Pereyra 1973: derivative of the pseudo-inverse, applied to x'.
    if n <= 6:
        apply_pseudo_inverse(J, rest, q_ss, view.solver)
        return True
    multiply(P, rest, q_ss)
    inner, twist = view.step, view.twist
    multiply_transposed(P, q_s, twist)
    multiply_transposed(J_s, twist, inner)
    for k in range(n):
        q_ss[k] += inner[k]
    multiply(J, inner, twist)
    multiply(P, twist, inner)
    for k in range(n):
        q_ss[k] -= inner[k]
    return True
