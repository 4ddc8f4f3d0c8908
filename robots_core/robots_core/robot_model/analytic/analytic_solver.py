"""AnalyticSolver: closed-form inverse kinematics of one robot, chosen by the lines of its axes."""

from collections.abc import Callable
from importlib import import_module
from typing import Any, Final

import numpy as np

from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.pose import Pose
from robots_core.robot_model.analytic.arm_record import spherical_wrist, ur_arm
from robots_core.robot_model.analytic.axis_lines import STRUCTURE_TOLERANCE, AxisLines, no_closed_form
from robots_core.robot_model.analytic.configuration import Configuration
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, read_only, rotation_matrix

# Solutions for a structure this exact are accurate to a few 1e-10; others are refined.
EXACT_DEVIATION = 5e-11
POLISH_STEPS = 4
POLISHED = 1e-11  # m and rad
POLISH_DROP = 1e-9  # guaranteed accuracy; candidates that stay above are no solutions
SINGULAR_RATIO = 1e-7  # of singular values; directions below it are left out of Newton steps

FAMILIES: Final[dict[str, Callable[[AxisLines], tuple[Any, float]]]] = {
    'spherical wrist': spherical_wrist,
    'parallel axes': ur_arm,
}


class AnalyticSolver:
    """All solutions of a six-axis robot for a pose, in closed form.

    Either axes 2 and 3 are parallel and axes 4, 5 and 6 meet in one point (Pieper 1968), or axes 2, 3 and 4
    are parallel and axes 5 and 6 meet; both forms hold for axes of any sign, zero position and offset.
    Angles that a singular pose leaves undetermined are those of home or of the given joint positions; if that
    breaks a limit, 63 other values are tried.

    An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        limited: Keep to the robot's limits; otherwise each branch has the turns nearest to mid-range.

    Raises:
        NoAnalyticInverseKinematicsError: the robot has another structure; names the reason.
    """

    def __init__(self, robot: BaseRobotModel, *, limited: bool = True) -> None:
        lines = AxisLines.of(robot)
        axes = robot.axes_data
        lower, upper = axes.lower, axes.upper
        near = robot.home
        if not limited:
            near, _ = axes.middle_and_half
            lower, upper = np.full(6, -np.inf), np.full(6, np.inf)
        self._robot = robot
        record, deviation = _structure(lines)
        record[0]['lower'], record[0]['upper'] = lower, upper
        record.flags.writeable = False
        self._record = record
        self._lower, self._upper = lower, upper
        self._near = read_only(np.clip(near, lower, upper))
        self._found = np.empty((9, 6))
        # Loading compiled code takes 0.2 s: done on first use of a closed form.
        self._kernel = import_module('robots_core.robot_model.analytic.analytic_kernel').solve
        self._forward, self._upward = _senses(record[0])
        self._exact = deviation <= EXACT_DEVIATION

    def solve(self, r: Array, T: Array, q_near: Array | None = None) -> Array:
        """See `BaseRobotModel.inverse_kinematics_analytic`."""
        near = self._near
        if q_near is not None:
            near = np.clip(finite_vector(q_near, 6, 'q_near'), self._lower, self._upper)
        try:
            count = self._kernel(self._record, r, T, near, self._found)
        except TypeError:  # arrays of other types than the kernel is compiled for
            count = -1
        if count < 0:
            r, T = finite_vector(r, 3, 'r'), rotation_matrix(T)
            count = self._kernel(self._record, r, T, near, self._found)
        solutions = self._found[:count].copy()
        return solutions if self._exact else self._polished(solutions, Pose(r, T))

    def configuration(self, q: Array) -> Configuration:
        """The configuration of joint positions (6,)."""
        arm = self._record[0]
        elbow = arm['sign_3'] * q[2] + arm['forearm_angle'] - arm['upper_arm_angle']
        raised = q[1] + arm['upper_arm_angle']
        reach = arm['shoulder'][0] + arm['upper_arm'] * np.cos(raised)
        reach += arm['forearm'] * np.cos(raised + elbow)
        turned = q[1] + arm['sign_3'] * q[2] + arm['sign_4'] * q[3]
        reach += arm['hand'] @ (np.cos(turned), -np.sin(turned))
        return Configuration(
            shoulder='front' if reach * self._forward >= 0.0 else 'back',
            elbow='up' if np.sin(elbow) * self._upward <= 0.0 else 'down',
            wrist='no_flip' if np.sin(q[4] + arm['straight']) >= 0.0 else 'flip',
        )

    def _polished(self, solutions: Array, pose: Pose) -> Array:
        """Newton steps with the robot's own kinematics, for axes slightly off the ideal structure."""
        kept = []
        for solution in solutions:
            q = solution.copy()
            for _ in range(POLISH_STEPS):
                error = self._robot.pose(q).error_to(pose)
                if np.abs(error).max() <= POLISHED:
                    break
                # Minimum-norm least squares, for the smallest motion in singularities.
                q += np.linalg.lstsq(self._robot.jacobian(q), error, rcond=SINGULAR_RATIO)[0]
            np.clip(q, self._lower, self._upper, out=q)
            error = self._robot.pose(q).error_to(pose)
            if np.abs(error).max() <= POLISH_DROP:
                kept.append(q)
        return np.array(kept).reshape(-1, 6)


def _structure(lines: AxisLines) -> tuple[Any, float]:
    reasons = []
    for family, derive in FAMILIES.items():
        try:
            return derive(lines)
        except NoAnalyticInverseKinematicsError as error:
            reasons.append(f'{family}: {error.details["reason"]}')
    raise no_closed_form(lines.name, '; '.join(reasons))


def _senses(arm: Any) -> tuple[float, float]:
    """Sign of the forward direction along X, and sign of the bend of elbows in the frame X, Y."""
    a, x, first = arm['basis']
    y = np.cross(arm['tilt_cos'] * a + arm['tilt_sin'] * first, x)
    sides = (arm['shoulder'][0], x[0], x[1], 1.0)
    forward = next(float(np.sign(side)) for side in sides if abs(side) > STRUCTURE_TOLERANCE)
    upward = -1.0 if y[2] < -STRUCTURE_TOLERANCE else 1.0
    return forward, forward * upward
