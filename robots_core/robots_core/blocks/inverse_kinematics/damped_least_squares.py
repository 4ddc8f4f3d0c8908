"""DampedLeastSquares: numerical inverse kinematics for any serial robot."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation
from scipy.stats import qmc

from robots_core.blocks.inverse_kinematics.ik_result import IkResult
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive

DAMPING_START = 1e-3
DAMPING_GROWTH = 8.0
DAMPING_HIGHEST = 1e8  # above, a step is shorter than rounding: the search stands still
# Newton's last steps shrink the error by orders of magnitude; damping of this size does not slow them.
DAMPING_LOWEST = 1e-14
LARGEST_STEP = 0.7  # rad (m) per axis; beyond, the linearisation says nothing about the pose
# A restart ends when this many steps together gain less than the factor: it crawls along a limit.
PROGRESS_STEPS = 12
PROGRESS_FACTOR = 0.9


@dataclass(frozen=True)
class _State:
    q: Array
    error: Array
    cost: float


class DampedLeastSquares:
    """Inverse kinematics by damped least squares with adaptive damping.

    Each step solves (J^T J + mu I) dq = J^T e for the axes that are free to move (Wampler 1986), where mu
    follows the gain of the last step (Levenberg-Marquardt). An axis that a step would carry past its limit
    is stopped at the limit and the others are solved again, so that every iterate is inside the limits.
    When the search stands still it starts again from a scrambled Sobol set; the same seed gives the same
    result.

    Args:
        robot: The robot.
        tolerances: Largest position error (m) and orientation error (rad) of a solution.
        max_iterations: Steps per start.
        restarts: Further starts after the one from `q_start`.
        seed: Of the restart points.

    Raises:
        InvalidInputError: an option that is not positive.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        tolerances: tuple[float, float] = (1e-10, 1e-10),
        max_iterations: int = 60,
        restarts: int = 24,
        seed: int = 0,
    ) -> None:
        self._robot = robot
        self._axes = robot.axes_data
        self._tolerances = (
            positive(tolerances[0], 'position tolerance', 'm'),
            positive(tolerances[1], 'orientation tolerance', 'rad'),
        )
        if max_iterations < 1:
            raise InvalidInputError(f'max_iterations = {max_iterations} must be at least 1')
        if restarts < 0:
            raise InvalidInputError(f'restarts = {restarts} must be at least 0')
        self._max_iterations = max_iterations
        self._restarts = restarts
        self._seed = seed
        self._starts: Array | None = None

    def solve(self, pose: Pose, q_start: ArrayLike) -> IkResult:
        """Joint positions that bring tool0 to `pose`, searched from `q_start`.

        Args:
            pose: Of tool0 in the base frame.
            q_start: Where to start, (n,), rad (m); inside the limits.

        Raises:
            JointLimitError: `q_start` outside the limits.
            InvalidInputError: `q_start` of another shape or not finite.
        """
        start = self._axes.check_position(q_start, 'q_start')
        best, iterations = self._search(pose, start, self._max_iterations)
        if not self._reached(best):
            for restart in self._restart_points():
                state, steps = self._search(pose, restart, self._max_iterations)
                iterations += steps
                if state.cost < best.cost:
                    best = state
                if self._reached(best):
                    break
        return IkResult(
            self._nearest_turn(best.q, start),
            self._reached(best),
            iterations,
            float(np.linalg.norm(best.error[:3])),
            float(np.linalg.norm(best.error[3:])),
        )

    def refine(self, pose: Pose, q_near: Array, max_iterations: int = 8) -> IkResult:
        """Like `solve` from a point close to the solution: few steps, no restarts, no checks."""
        state, iterations = self._search(pose, q_near, max_iterations)
        return IkResult(
            state.q,
            self._reached(state),
            iterations,
            float(np.linalg.norm(state.error[:3])),
            float(np.linalg.norm(state.error[3:])),
        )

    def _search(self, pose: Pose, start: Array, max_iterations: int) -> tuple[_State, int]:
        state = self._evaluate(pose, np.clip(start, self._axes.lower, self._axes.upper))
        damping, growth = DAMPING_START, DAMPING_GROWTH
        costs = [state.cost]
        for iteration in range(max_iterations):
            if self._reached(state):
                return state, iteration
            J = self._robot.jacobian(state.q)
            while True:
                candidate = self._evaluate(pose, state.q + self._step(J, state, damping))
                if candidate.cost < state.cost:
                    # Close to the solution damping fades with the error, which makes the last steps Newton's.
                    damping = max(min(damping / DAMPING_GROWTH**2, candidate.cost), DAMPING_LOWEST)
                    growth = DAMPING_GROWTH
                    state = candidate
                    break
                damping, growth = max(damping, 1e-9) * growth, 2.0 * growth
                if damping > DAMPING_HIGHEST:
                    return state, iteration + 1
            costs.append(state.cost)
            if iteration >= PROGRESS_STEPS and costs[-1] > PROGRESS_FACTOR * costs[-1 - PROGRESS_STEPS]:
                return state, iteration + 1
        return state, max_iterations

    def _step(self, J: Array, state: _State, damping: float) -> Array:
        """Damped step with axes at their limits held, (n,)."""
        lower, upper = self._axes.lower - state.q, self._axes.upper - state.q
        step = np.zeros(self._axes.num_axes)
        gradient = J.T @ state.error
        free = ~(((lower >= 0.0) & (gradient < 0.0)) | ((upper <= 0.0) & (gradient > 0.0)))
        error = state.error
        while free.any():
            Jf = J[:, free]
            normal = Jf.T @ Jf
            normal.flat[:: normal.shape[0] + 1] += damping
            dq = np.linalg.solve(normal, Jf.T @ error)
            low, high = lower[free], upper[free]
            clipped = np.clip(dq, low, high)
            past = clipped != dq
            step[free] = clipped
            if not past.any():
                break
            stopped: NDArray[np.intp] = np.flatnonzero(free)[past]
            error = error - J[:, stopped] @ step[stopped]
            free[stopped] = False
        largest = float(np.abs(step).max())
        if largest > LARGEST_STEP:
            step *= LARGEST_STEP / largest
        return step

    def _evaluate(self, pose: Pose, q: Array) -> _State:
        # Rounding of q + step may pass a limit by one unit in the last place.
        inside = np.clip(q, self._axes.lower, self._axes.upper)
        r, T = self._robot.direct_kinematics(inside)
        error = pose_error(r, T, pose.r, pose.T)
        return _State(inside, error, float(error @ error))

    def _reached(self, state: _State) -> bool:
        e = state.error
        return (
            sqrt(float(e[:3] @ e[:3])) <= self._tolerances[0]
            and sqrt(float(e[3:] @ e[3:])) <= self._tolerances[1]
        )

    def _restart_points(self) -> Array:
        if self._starts is None:
            axes = self._axes
            low = np.where(np.isfinite(axes.lower), axes.lower, -np.pi)
            high = np.where(np.isfinite(axes.upper), axes.upper, np.pi)
            # Sobol sets are balanced at powers of two.
            power = max(self._restarts - 1, 1).bit_length()
            sobol = qmc.Sobol(axes.num_axes, scramble=True, rng=np.random.default_rng(self._seed))
            self._starts = low + sobol.random_base2(power)[: self._restarts] * (high - low)
        return self._starts

    def _nearest_turn(self, q: Array, reference: Array) -> Array:
        """The same posture with full turns added inside the limits, each axis nearest to `reference`."""
        axes = self._axes
        turned = q + 2.0 * np.pi * np.round((reference - q) / (2.0 * np.pi))
        allowed = (turned >= axes.lower) & (turned <= axes.upper) & ~np.array(axes.prismatic)
        return np.where(allowed, turned, q)


def pose_error(r: Array, T: Array, r_target: Array, T_target: Array) -> Array:
    """As `Pose.error_to`, fast: translation (m), then rotation vector (rad), (6,), base frame."""
    E = T_target @ T.T
    error = np.empty(6)
    error[:3] = r_target - r
    x, y, z = E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]
    sine = sqrt(x * x + y * y + z * z)  # twice the sine and twice the cosine of the angle
    cosine = E[0, 0] + E[1, 1] + E[2, 2] - 1.0
    if cosine < -1.9 and sine < 0.6:  # near half a turn the axis is lost in rounding
        error[3:] = Rotation.from_matrix(E).as_rotvec()
        return error
    factor = atan2(sine, cosine) / sine if sine > 1e-12 else 0.5
    error[3], error[4], error[5] = factor * x, factor * y, factor * z
    return error
