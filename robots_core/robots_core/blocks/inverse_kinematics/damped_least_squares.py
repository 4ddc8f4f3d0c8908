"""DampedLeastSquares: numerical inverse kinematics for any serial robot."""

import os
from concurrent.futures import ThreadPoolExecutor
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.inverse_kinematics.damped_least_squares_kernel import (
    PROGRESS_STEPS,
    reached,
    solve_pose,
    solve_poses,
)
from robots_core.blocks.inverse_kinematics.ik_result import IkBatch, IkResult
from robots_core.blocks.inverse_kinematics.redundancy import Redundancy, redundancy_arrays
from robots_core.errors import InvalidInputError
from robots_core.kernels.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import ROTATION_TOLERANCE, Array, positive, read_only

CHUNKS_PER_CORE = 4  # of a batch, for load balancing


class DampedLeastSquares:
    """Inverse kinematics by damped least squares with adaptive damping.

    Each step solves (J^T J + mu I) dq = J^T e for the axes that are free to move (Wampler 1986), where mu
    follows the gain of the last step (Levenberg-Marquardt). An axis that a step would carry past its limit
    is stopped at the limit and the others are solved again, so that every iterate is inside the limits.
    When the search stagnates it restarts from a low-discrepancy set (Roberts 2018, the additive
    recurrence of the generalised golden ratio, shifted by `seed`); the same seed gives the same result.

    The search is compiled; it works on the axes as screws, taken from the robot once. An instance keeps
    scratch memory: use one per thread.

    Args:
        robot: The robot.
        tolerances: Largest position error (m) and orientation error (rad) of a solution.
        max_iterations: Steps per start.
        restarts: Further starts after the one from `q_start`.
        seed: Of the restart points.
        tool: Pose of the tool centre point in tool0; tool0 itself by default.
        redundancy: Secondary criterion for the degrees of freedom that the pose leaves: from the solution,
            self-motion continues until the criterion is satisfied.

    Raises:
        InvalidInputError: an option that is not positive, or a robot whose axes are coupled.
        JointLimitError: the preferred positions of the redundancy criterion lie outside the limits.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        tolerances: tuple[float, float] = (1e-10, 1e-10),
        max_iterations: int = 60,
        restarts: int = 300,
        seed: int = 0,
        tool: Pose | None = None,
        redundancy: Redundancy | None = None,
    ) -> None:
        self._axes = robot.axes_data
        if max_iterations < 1:
            raise InvalidInputError(f'max_iterations = {max_iterations} must be at least 1')
        if restarts < 0:
            raise InvalidInputError(f'restarts = {restarts} must be at least 0')
        self._tolerances = (
            positive(tolerances[0], 'position tolerance', 'm'),
            positive(tolerances[1], 'orientation tolerance', 'rad'),
        )
        limits = np.array([self._axes.lower, self._axes.upper])
        offset = np.random.default_rng(seed).uniform(size=self._axes.num_axes)
        self._fixed = (
            (SerialChain.of(robot, tool).arrays, limits, self._tolerances),
            low_discrepancy(self._axes, restarts, offset),
            redundancy_arrays(redundancy, self._axes),
            (int(max_iterations), PROGRESS_STEPS),
        )
        self._target = (np.empty(3), np.empty((3, 3)))

    def solve(self, pose: Pose, q_start: ArrayLike) -> IkResult:
        """Joint positions that bring the tool to `pose`, searched from `q_start`.

        Args:
            pose: Of the tool centre point in the base frame.
            q_start: Joint positions to start from, (n,), rad (m); inside the limits.

        Returns:
            The solution, with full turns nearest to `q_start`; the closest joint positions found otherwise.

        Raises:
            JointLimitError: `q_start` outside the limits.
            InvalidInputError: `q_start` of another shape or not finite.
        """
        q, error = self._axes.check_position(q_start, 'q_start').copy(), np.empty(6)
        # Compiled code is specialised for one memory layout; another would take many seconds to compile.
        self._target[0][:], self._target[1][:] = pose.r, pose.T
        steps = solve_pose(*self._fixed, self._target, q, error)
        x, y, z, a, b, c = error.tolist()
        return IkResult(
            q,
            reached(self._tolerances, error),
            steps,
            sqrt(x * x + y * y + z * z),
            sqrt(a * a + b * b + c * c),
        )

    def solve_many(self, r: ArrayLike, T: ArrayLike, q_start: ArrayLike) -> IkBatch:
        """`solve` for many poses at once, on all cores; the results are the same.

        Args:
            r: Positions of the tool centre point, (m, 3), m.
            T: Its orientations, (m, 3, 3).
            q_start: Where to start, (n,) for all or (m, n), rad (m); inside the limits.

        Raises:
            JointLimitError: a start outside the limits.
            InvalidInputError: arrays of other shapes, not finite, or a T that is no rotation.
        """
        positions, orientations = _checked_poses(r, T)
        count, n = len(positions), self._axes.num_axes
        starts = np.asarray(q_start, dtype=np.float64)
        if starts.shape not in ((n,), (count, n)):
            raise InvalidInputError(f'q_start has shape {starts.shape}, needed is ({n},) or ({count}, {n})')
        for start in starts.reshape(-1, n):
            self._axes.check_position(start, 'q_start')
        q = np.array(np.broadcast_to(starts, (count, n)), order='C')
        errors, steps = np.empty((count, 6)), np.empty(count, dtype=np.int64)

        def solve_part(part: slice) -> None:
            poses = positions[part], orientations[part]
            solve_poses(*self._fixed, *poses, q[part], errors[part], steps[part])

        cores = len(os.sched_getaffinity(0))
        size = max(1, -(-count // (cores * CHUNKS_PER_CORE)))
        # Compiled code runs without the interpreter's lock.
        with ThreadPoolExecutor(cores) as pool:
            list(pool.map(solve_part, [slice(begin, begin + size) for begin in range(0, count, size)]))
        position_error = np.linalg.norm(errors[:, :3], axis=1)
        orientation_error = np.linalg.norm(errors[:, 3:], axis=1)
        most_position, most_orientation = self._tolerances
        converged = (position_error <= most_position) & (orientation_error <= most_orientation)
        return IkBatch(q, converged, steps, position_error, orientation_error)


def low_discrepancy(axes: AxesData, count: int, offset: Array | float) -> Array:
    """Points that fill the joint space evenly, (count, n); continuous axes within half a turn of 0."""
    n = axes.num_axes
    low, high = axes.one_turn
    ratio = 2.0  # the positive root of x^(n+1) = x + 1
    for _ in range(60):
        ratio = (1.0 + ratio) ** (1.0 / (n + 1.0))
    points = (offset + np.outer(np.arange(1, count + 1), ratio ** -np.arange(1.0, n + 1.0))) % 1.0
    return read_only(low + points * (high - low))


def _checked_poses(r: ArrayLike, T: ArrayLike) -> tuple[Array, Array]:
    positions = np.array(r, dtype=np.float64, order='C')
    orientations = np.array(T, dtype=np.float64, order='C')
    if positions.ndim != 2 or positions.shape[1] != 3 or orientations.shape != (len(positions), 3, 3):
        raise InvalidInputError(
            f'r has shape {positions.shape} and T {orientations.shape}, needed are (m, 3) and (m, 3, 3)'
        )
    deviation = np.abs(orientations @ orientations.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2), initial=0)
    handedness = (np.cross(orientations[:, 0], orientations[:, 1]) * orientations[:, 2]).sum(axis=1)
    right = (deviation <= ROTATION_TOLERANCE) & (handedness > 0.0)
    right &= np.isfinite(positions).all(axis=1)
    if not right.all():
        worst = int(np.flatnonzero(~right)[0])
        raise InvalidInputError(f'pose {worst} is not a finite position with a rotation matrix', index=worst)
    return positions, orientations
