"""AnalyticalInverseKinematic: all solutions for a pose in closed form (the paper's block)."""

from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import NoAnalyticInverseKinematicsError, UnreachablePoseError
from robots_core.pose import Pose
from robots_core.robot_model.analytic.analytic_solver import AnalyticSolver
from robots_core.robot_model.analytic.configuration import Configuration
from robots_core.robot_model.axes_data import LIMIT_TOLERANCE
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector

TURN = 2.0 * np.pi


class AnalyticalInverseKinematic:
    """Inverse kinematics in closed form of a robot that carries a tool.

    Args:
        robot: The robot; one that offers `inverse_kinematics_analytic`.
        tool: Pose of the tool centre point in tool0; tool0 itself by default.

    Raises:
        NoAnalyticInverseKinematicsError: the robot has no closed form; names the reason.
    """

    def __init__(self, robot: BaseRobotModel, *, tool: Pose | None = None) -> None:
        self.robot = robot
        self._axes = robot.axes_data
        self._to_tool0 = None if tool is None else tool.inverse()
        # Raises here, rather than on first use, if there is no closed form.
        robot.inverse_kinematics_analytic(*robot.direct_kinematics(robot.home))

    def solve_all(self, pose: Pose, *, turns: bool = False) -> Array:
        """All joint positions inside the limits that bring the tool to a pose, one row per branch.

        Args:
            pose: Of the tool in the base frame.
            turns: Also solutions that differ by full turns of axes, as far as the limits allow; axes without
                limits have one, the nearest to home.

        Returns:
            (k, n) rad; k = 0 if nothing inside the limits reaches the pose.
        """
        target = self._tool0_pose(pose)
        branches = self.robot.inverse_kinematics_analytic(target.r, target.T)
        return np.vstack([self._turned(q) for q in branches]) if turns and len(branches) else branches

    def solve(
        self, pose: Pose, seed: ArrayLike | None = None, *, configuration: Configuration | None = None
    ) -> Array:
        """The solution nearest to the seed.

        Nearest means the smallest Euclidean norm of the displacements divided by the axes' speed limits; axes
        that a singular pose leaves undetermined keep their position in the seed.

        Args:
            pose: Of the tool in the base frame.
            seed: Joint positions, (n,) rad; home by default.
            configuration: Only solutions of this configuration.

        Returns:
            (n,) rad, inside the limits, with the full turns nearest to the seed.

        Raises:
            UnreachablePoseError: no such solution inside the limits; names the limit that the nearest branch
                breaks, or states that the pose is out of reach.
            InvalidInputError: a seed of another shape or not finite.
            NoAnalyticInverseKinematicsError: a configuration of a robot with a closed form of its own.
        """
        near = self.robot.home if seed is None else finite_vector(seed, self._axes.num_axes, 'seed')
        target = self._tool0_pose(pose)
        branches = self.robot.inverse_kinematics_analytic(target.r, target.T, q_near=near)
        if configuration is not None:
            branches = branches[[self.configuration(q) == configuration for q in branches]]
        if len(branches) == 0:
            raise self._unreachable(target, configuration)
        times = (branches - near) / self._axes.velocity
        nearest: Array = branches[int(np.argmin(np.einsum('ij,ij->i', times, times)))]
        return nearest

    def configuration(self, q: ArrayLike) -> Configuration:
        """The configuration of joint positions `q`, (n,).

        Raises:
            InvalidInputError: another shape or not finite.
            NoAnalyticInverseKinematicsError: a robot with a closed form of its own.
        """
        return self._unlimited.configuration(finite_vector(q, self._axes.num_axes, 'q'))

    @cached_property
    def _unlimited(self) -> AnalyticSolver:
        return AnalyticSolver(self.robot, limited=False)

    def _tool0_pose(self, pose: Pose) -> Pose:
        return pose if self._to_tool0 is None else pose @ self._to_tool0

    def _turned(self, q: Array) -> Array:
        axes = self._axes
        first = np.ceil((axes.lower - LIMIT_TOLERANCE - q) / TURN)
        last = np.floor((axes.upper + LIMIT_TOLERANCE - q) / TURN)
        continuous = np.isinf(axes.lower)
        first[continuous] = last[continuous] = 0.0
        turns = [range(int(low), int(high) + 1) for low, high in zip(first, last, strict=True)]
        turned: Array = np.clip(q + TURN * np.array(list(product(*turns))), axes.lower, axes.upper)
        return turned

    def _unreachable(self, target: Pose, configuration: Configuration | None) -> UnreachablePoseError:
        where = f'tool0 at ({", ".join(f"{value:.6g}" for value in target.r)}) m'
        asked = '' if configuration is None else f' in configuration {configuration}'
        try:
            branches = self._unlimited.solve(target.r, target.T)
        except NoAnalyticInverseKinematicsError:
            return UnreachablePoseError(f'{where}: no solution inside the limits{asked}')
        if configuration is not None:
            branches = branches[[self.configuration(q) == configuration for q in branches]]
        if len(branches) == 0:
            return UnreachablePoseError(f'{where} is out of reach{asked}, even without limits')
        axes = self._axes
        outside = np.maximum(axes.lower - branches, branches - axes.upper)
        branch = int(np.argmin(outside.max(axis=1)))
        axis = int(np.argmax(outside[branch]))
        name, value = axes.names[axis], float(branches[branch, axis])
        lower, upper = float(axes.lower[axis]), float(axes.upper[axis])
        return UnreachablePoseError(
            f'{where}: no solution inside the limits{asked}; the nearest needs {name} = {value:.9g} rad, '
            f'its limits are [{lower:.9g}, {upper:.9g}] rad',
            joint=name,
            value=value,
            lower=lower,
            upper=upper,
            unit='rad',
        )
