"""HeldInverseKinematics: joint positions for a position, and of an orientation what the arm can."""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.inverse_kinematics.closest_orientation_kernel import correct, residual
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares, low_discrepancy
from robots_core.blocks.inverse_kinematics.damped_least_squares_kernel import (
    PATIENT,
    PROGRESS_STEPS,
    search,
)
from robots_core.blocks.inverse_kinematics.hold import DIRECTIONS, POSE, condition_rows, held_by
from robots_core.blocks.inverse_kinematics.ik_result import IkResult
from robots_core.kernels.serial_chain import ChainArrays, SerialChain
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

TOLERANCE: Final = 1e-10  # m and rad
MAX_ITERATIONS: Final = 60
RESTARTS: Final = 100  # until the position is reached
POSTURES: Final = 12  # from which the closest orientation is searched
DESCENT_STEPS: Final = 60
DAMPING: Final = (1e-6, 1e-12, 1e6)  # at first, lowest and highest
POLISH_BELOW: Final = 1e-3  # of the conditions of the closest orientation, for Newton's method
POLISH_STEPS: Final = 12
LARGEST_STEP: Final = 0.5  # rad (m)
SAME_ORIENTATION: Final = 1e-6  # rad, by which one posture is no better than another


def inverse_kinematics_for(
    robot: BaseRobotModel, *, tool: Pose | None = None, hold: str = POSE
) -> 'DampedLeastSquares | HeldInverseKinematics':
    """Numerical inverse kinematics for what a motion holds, resolved by `held_by`."""
    if hold == POSE:
        return DampedLeastSquares(robot, tool=tool)
    return HeldInverseKinematics(robot, tool=tool, hold=hold)


class HeldInverseKinematics:
    """Inverse kinematics of arms that hold less than a pose.

    The position is found by damped least squares, with three axes through the tool centre point that turn
    freely behind the arm's own. The closest orientation is then found by self-motion (Levenberg-Marquardt in
    the null space of the position) from several postures, and Newton's method on its conditions. Among
    postures with the same orientation, the nearest to the start is taken.

    Args:
        robot: The robot.
        tool: Pose of the tool centre point in tool0; tool0 itself by default.
        hold: 'directions' or 'position', see `held_by`; what the arm can by default.
        restarts: Further starts after the one from `q_start`, until the position is reached.

    Raises:
        InvalidInputError: a robot whose axes are coupled, or a `hold` that does not exist.
    """

    def __init__(
        self, robot: BaseRobotModel, *, tool: Pose | None = None, hold: str = '', restarts: int = RESTARTS
    ) -> None:
        self._axes = robot.axes_data
        n = robot.num_axes
        self.hold = held_by(n, hold)
        self._rows = condition_rows(self.hold, n)
        self._chain = SerialChain.of(robot, tool)
        turn = np.full(3, np.inf)
        limits = np.array([[*self._axes.lower, *-turn], [*self._axes.upper, *turn]])
        self._free = _with_free_wrist(self._chain), limits, (TOLERANCE, TOLERANCE)
        self._starts = low_discrepancy(self._axes, restarts, 0.5)

    def solve(self, pose: Pose, q_start: ArrayLike) -> IkResult:
        """Joint positions that bring the tool to the position of `pose`, as close to its orientation as held.

        Args:
            pose: Of the tool centre point in the base frame.
            q_start: Joint positions to start from, (n,), rad (m); inside the limits.

        Returns:
            The solution; converged if the position is reached. The orientation error is what is left of it.

        Raises:
            JointLimitError: `q_start` outside the limits.
            InvalidInputError: `q_start` of another shape or not finite.
        """
        start = self._axes.check_position(q_start, 'q_start')
        best, steps = self._at_position(pose, start)
        missed = self._result(pose, best, steps)
        if missed.position_error > TOLERANCE:
            for other in self._starts:
                q, more = self._at_position(pose, other)
                steps += more
                found = self._result(pose, q, steps)
                if found.position_error < missed.position_error:
                    best, missed = q, found
                if missed.position_error <= TOLERANCE:
                    break
        if self.hold != DIRECTIONS or missed.position_error > TOLERANCE:
            return missed
        return self._closest(pose, start, best, steps)

    def _closest(self, pose: Pose, start: Array, first: Array, steps: int) -> IkResult:
        found = [self._result(pose, self._turned(pose, first), steps)]
        for other in self._starts[:POSTURES]:
            q, more = self._at_position(pose, other)
            steps += more
            result = self._result(pose, self._turned(pose, q), steps)
            if result.position_error <= TOLERANCE:
                found.append(result)
        least = min(result.orientation_error for result in found)
        able = [result for result in found if result.orientation_error <= least + SAME_ORIENTATION]
        return min(able, key=lambda result: float(np.abs(result.q - start).max()))

    def _at_position(self, pose: Pose, start: Array) -> tuple[Array, int]:
        """Joint positions (n,) for the position, or the closest found, and the steps taken."""
        n, error = self._axes.num_axes, np.empty(6)
        q = np.concatenate([start, np.zeros(3)])
        # The orientation at the start is that to which the free axes belong: they begin where they should be.
        target = (np.array(pose.r), np.array(self._chain.forward(start).T))
        effort = (MAX_ITERATIONS, PROGRESS_STEPS if self._rows > 3 else PATIENT)
        steps = search(self._free, effort, target, q, error)
        return self._near(start, q[:n].copy()), int(steps)

    def _near(self, start: Array, q: Array) -> Array:
        """The same posture, with full turns nearest to the start."""
        turned = q + 2.0 * np.pi * np.round((start - q) / (2.0 * np.pi))
        able = (turned >= self._axes.lower) & (turned <= self._axes.upper) & ~np.array(self._axes.prismatic)
        return np.where(able, turned, q)

    def _turned(self, pose: Pose, q: Array) -> Array:
        """The closest orientation by self-motion from `q`, (n,)."""
        n = q.size
        damping, lowest, highest = DAMPING
        J, error, gradient = np.empty((6, n)), np.empty(6), np.empty(n)
        r, T = np.array(pose.r), np.array(pose.T)
        if not residual(self._chain.arrays, q, r, T, J, error, gradient):
            return q
        for _ in range(DESCENT_STEPS):
            if np.abs(gradient).max() < POLISH_BELOW:
                exact = q.copy()
                if self._corrected(exact, pose, self._rows, POLISH_STEPS):
                    return exact
            if np.abs(gradient).max() < TOLERANCE or damping > highest:
                break
            _, _, directions = np.linalg.svd(J[:3])
            free = directions[3:].T
            B = J[3:] @ free
            step = free @ np.linalg.solve(B.T @ B + damping * np.eye(n - 3), B.T @ error[3:])
            step *= min(1.0, LARGEST_STEP / max(float(np.abs(step).max()), TOLERANCE))
            moved, angle = q + step, float(error[3:] @ error[3:])
            other_J, other_error, other_gradient = np.empty((6, n)), np.empty(6), np.empty(n)
            if (
                self._corrected(moved, pose, 3, POLISH_STEPS)
                and residual(self._chain.arrays, moved, r, T, other_J, other_error, other_gradient)
                and other_error[3:] @ other_error[3:] < angle
            ):
                q, J, error, gradient = moved, other_J, other_error, other_gradient
                damping = max(0.1 * damping, lowest)
            else:
                damping *= 10.0
        return q

    def _corrected(self, q: Array, pose: Pose, rows: int, steps: int) -> bool:
        """Newton's method in place; False where it does not converge inside the limits."""
        r, T = np.array(pose.r), np.array(pose.T)
        if not correct(self._chain.arrays, q, r, T, rows, 0.1 * TOLERANCE, steps, LARGEST_STEP):
            return False
        return bool(((q >= self._axes.lower) & (q <= self._axes.upper)).all())

    def _result(self, pose: Pose, q: Array, steps: int) -> IkResult:
        position, angle = self._chain.forward(q).distance_to(pose)
        return IkResult(q, position <= TOLERANCE, steps, position, angle)


def _with_free_wrist(chain: SerialChain) -> ChainArrays:
    """Arrays of a chain with three more axes through its tool centre point."""
    free = SerialChain(
        np.concatenate([chain.directions, chain.T.T]),  # the tool's own axes, in the base frame
        np.concatenate([chain.points, np.tile(chain.r, (3, 1))]),
        np.append(chain.prismatic, [False] * 3),
        chain.r,
        chain.T,
    )
    return free.arrays
