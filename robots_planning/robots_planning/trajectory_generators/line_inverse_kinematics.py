"""Inverse kinematics along a Cartesian line: from poses over s to a joint path over s."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares, pose_error
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory_generators.cartesian_line import CartesianLine
from robots_planning.trajectory_generators.joint_path import JointPath

FIRST_STEP = 1.0 / 16.0
LONGEST_STEP = 1.0 / 8.0
SHORTEST_STEP = 1e-7  # of the line; a joint path that needs finer knots jumps
MOST_KNOTS = 4000
# Between knots the tool may leave the line by this much, in m and rad; 1e-5 is what users are promised.
LINE_TOLERANCE = 2e-7
CORRECTION_TOLERANCE = 1e-10  # m and rad, at the knots
LARGEST_KNOT_MOTION = 0.25  # rad (m) of one axis from knot to knot; more may hide a change of configuration
# Ratio of singular values below which a direction of the tool counts as lost.
SINGULAR = 1e-9
LOST_MOTION = 1e-7  # part of the tool's motion along the line that may be missing in a singular posture
POSITION_TOLERANCE = 1e-9  # rad (m), of the axis limits


@dataclass(frozen=True)
class _Knot:
    s: float
    q: Array
    q_s: Array
    q_ss: Array


class LineInverseKinematics:
    """Follows a line with q' = J^+ x' and q'' = d/ds (J^+ x'), knot by knot, each corrected by Newton.

    Redundant robots move with the smallest joint motion (pseudo-inverse). Knots are as far apart as the
    interpolation between them stays on the line; near a singularity they come close together.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot
        self._axes = robot.axes_data
        self._redundant = robot.num_axes != 6

    def follow(self, line: CartesianLine, start: Array) -> JointPath:
        """The joint path (k knots) of a line that begins at joint positions `start`, (n,).

        Raises:
            PlanningError: the line leaves the axis limits or the reach, or crosses a singularity; names the
                fraction of the line, the joint, its value and bound, and what would help.
        """
        knot = self._first_knot(line, start)
        knots = [knot]
        step = FIRST_STEP
        while knot.s < 1.0:
            end = min(knot.s + step, 1.0)
            if 1.0 - end < SHORTEST_STEP:
                end = 1.0
            advance = self._next_knot(line, knot, end)
            if advance is None:
                step = 0.5 * (end - knot.s)
                if step < SHORTEST_STEP or len(knots) >= MOST_KNOTS:
                    raise self._blocked(line, knot)
                continue
            following, deviation = advance
            self._check_limits(line, knot, following)
            step = end - knot.s
            # The deviation grows with the sixth power of the step.
            growth = 0.9 * (LINE_TOLERANCE / max(deviation, 1e-16)) ** (1.0 / 6.0)
            step = min(step * min(max(growth, 0.5), 2.0), LONGEST_STEP)
            knots.append(following)
            knot = following
        return JointPath(
            np.array([knot.s for knot in knots]),
            np.array([knot.q for knot in knots]),
            np.array([knot.q_s for knot in knots]),
            np.array([knot.q_ss for knot in knots]),
        )

    def _first_knot(self, line: CartesianLine, start: Array) -> _Knot:
        knot = self._derivatives(line, 0.0, start)
        if knot is None:
            raise self._singular(line, 0.0, start)
        return knot

    def _next_knot(self, line: CartesianLine, knot: _Knot, s: float) -> tuple[_Knot, float] | None:
        """The knot at `s` and the deviation in between; None if the step is too long."""
        h = s - knot.s
        q = self._correct(line, s, knot.q + h * (knot.q_s + 0.5 * h * knot.q_ss))
        following = None if q is None else self._derivatives(line, s, q)
        if following is not None and self._redundant:
            # The tool does not determine a redundant axis: integrate it to fourth order (Hermite).
            q = self._correct(
                line,
                s,
                knot.q + 0.5 * h * (knot.q_s + following.q_s) + h * h / 12.0 * (knot.q_ss - following.q_ss),
            )
            following = None if q is None else self._derivatives(line, s, q)
        if following is None or float(np.abs(following.q - knot.q).max()) > LARGEST_KNOT_MOTION:
            return None
        deviation = self._deviation(line, knot, following)
        return None if deviation > LINE_TOLERANCE else (following, deviation)

    def _deviation(self, line: CartesianLine, knot: _Knot, following: _Knot) -> float:
        """How far the interpolation's middle is off the line: the larger of m and rad."""
        h = following.s - knot.s
        middle = (
            0.5 * (knot.q + following.q)
            + 5.0 / 32.0 * h * (knot.q_s - following.q_s)
            + h * h / 64.0 * (knot.q_ss + following.q_ss)
        )
        error = self._error(line, 0.5 * (knot.s + following.s), middle)
        return float(np.abs(error).max())

    def _error(self, line: CartesianLine, s: float, q: Array) -> Array:
        r, T = self._robot.direct_kinematics(q)
        r_line, T_line = line.frame(s)
        return pose_error(r, T, r_line, T_line)

    def _correct(self, line: CartesianLine, s: float, q: Array) -> Array | None:
        """Newton's method from a close guess; None if it does not converge in a few steps."""
        for _ in range(5):
            error = self._error(line, s, q)
            if float(np.abs(error).max()) < CORRECTION_TOLERANCE:
                return q
            step, _ = solve_least_motion(self._robot.jacobian(q), error)
            if float(np.abs(step).max()) > LARGEST_KNOT_MOTION:
                return None
            q = q + step
        return None

    def _derivatives(self, line: CartesianLine, s: float, q: Array) -> _Knot | None:
        """The knot with q' and q'' at a point of the line; None where the posture cannot move along it."""
        x_s = line.derivative
        J = self._robot.jacobian(q)
        q_s, lost = solve_least_motion(J, x_s)
        if lost > LOST_MOTION * float(np.linalg.norm(x_s)):
            return None
        J_s = self._robot.jacobian_der(q, q_s)
        # Golub and Pereyra 1973: derivative of the pseudo-inverse, applied to x', which is constant.
        q_ss, _ = solve_least_motion(J, -J_s @ q_s)
        if self._redundant:
            dual, _ = solve_least_motion(J.T, q_s)
            inner = J_s.T @ dual
            q_ss = q_ss + inner - solve_least_motion(J, J @ inner)[0]
        return _Knot(s, q, q_s, q_ss)

    def _check_limits(self, line: CartesianLine, knot: _Knot, following: _Knot) -> None:
        axes, q = self._axes, following.q
        excess = np.maximum(axes.lower - q, q - axes.upper)
        if float(excess.max()) <= POSITION_TOLERANCE:
            return
        axis = int(np.argmax(excess))
        bound = float(axes.lower[axis] if q[axis] < axes.lower[axis] else axes.upper[axis])
        span = float(q[axis] - knot.q[axis])
        part = min(max((bound - float(knot.q[axis])) / span, 0.0), 1.0) if span else 0.0
        fraction = knot.s + part * (following.s - knot.s)
        name, unit = axes.names[axis], axes.unit(axis)
        raise PlanningError(
            f'the line leaves the axis limits at {100.0 * fraction:.1f} % of its {length_text(line)}: '
            f'{name} would pass {bound:.6g} {unit} and have {q[axis]:.6g} {unit} at '
            f'{100.0 * following.s:.1f} %, allowed is [{axes.lower[axis]:.6g}, {axes.upper[axis]:.6g}] '
            f'{unit}; start in another configuration, shorten the line, or move in joint space',
            fraction=fraction,
            joint=name,
            value=float(q[axis]),
            bound=bound,
            unit=unit,
        )

    def _blocked(self, line: CartesianLine, knot: _Knot) -> PlanningError:
        """Why no step along the line is possible from `knot`: out of reach, or a singularity."""
        s = min(knot.s + 1e-3, 1.0)
        inside = np.clip(knot.q, self._axes.lower, self._axes.upper)
        near = DampedLeastSquares(self._robot).solve(Pose(*line.frame(s)), inside)
        if near.converged:
            return self._singular(line, knot.s, knot.q)
        return PlanningError(
            f'the line leaves the reach of {self._robot.name} at {100.0 * knot.s:.1f} % of its '
            f'{length_text(line)}: the closest posture at {100.0 * s:.1f} % is '
            f'{near.position_error * 1e3:.3g} mm and {near.orientation_error:.3g} rad off; move the line '
            'closer to the robot or turn the tool',
            fraction=knot.s,
            position_error=near.position_error,
            orientation_error=near.orientation_error,
        )

    def _singular(self, line: CartesianLine, s: float, q: Array) -> PlanningError:
        _, values, directions = np.linalg.svd(self._robot.jacobian(q))
        axis = int(np.argmax(np.abs(directions[len(values) - 1])))
        name = self._axes.names[axis]
        return PlanningError(
            f'the line meets a singularity at {100.0 * s:.1f} % of its {length_text(line)}: {name} '
            f'would have to turn without bound at {q[axis]:.6g} {self._axes.unit(axis)} '
            f'(smallest singular value of the '
            f'Jacobian {values[-1]:.2g}); move in joint space, or shift or tilt the line a little',
            fraction=s,
            joint=name,
            value=float(q[axis]),
            smallest_singular_value=float(values[-1]),
        )


def solve_least_motion(J: Array, x: Array) -> tuple[Array, float]:
    """The shortest y with J y = x as nearly as possible, and how much of x is missing.

    Directions with a singular value below `SINGULAR` of the largest are left out.
    """
    U, values, Vt = np.linalg.svd(J, full_matrices=False)
    parts = U.T @ x
    kept = values > SINGULAR * values[0]
    if kept.all():
        lost = 0.0 if J.shape[0] <= J.shape[1] else float(np.linalg.norm(x - U @ parts))
        return Vt.T @ (parts / values), lost
    y = Vt[kept].T @ (parts[kept] / values[kept])
    return y, float(np.linalg.norm(x - J @ y))


def length_text(line: CartesianLine) -> str:
    """'0.300 m', '0.500 rad' or both."""
    parts = [f'{line.length:.3f} m'] if line.length > 0.0 else []
    parts += [f'{line.angle:.3f} rad'] if line.angle > 0.0 else []
    return ' and '.join(parts)
