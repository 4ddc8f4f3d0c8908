# ruff: noqa: PLR0917  # compiled functions take arrays
"""TorqueLimits: the limits of the axes' torques along a path."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from robots_core.errors import InvalidInputError, PlanningError
from robots_core.kernels.chain_dynamics import (
    ChainDynamics,
    DynamicsArrays,
    bodies_of,
    fill_dynamics,
    fill_torques,
)
from robots_core.kernels.compiled import compiled
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class TorqueLimits:
    """Torques of the robot's rigid dynamics, gravity included, over their limits.

    Args:
        robot: The robot.
        effort: Highest torque per axis, (n,), N m (N).
    """

    def __init__(self, robot: BaseRobotModel, effort: Array) -> None:
        # A copy: read-only arrays would be compiled for once more.
        self._robot, self._effort = robot, np.array(effort)
        self._dynamics: ChainDynamics | None = None
        with suppress(InvalidInputError):  # of robots whose own methods alone compute them
            self._dynamics = ChainDynamics.of(robot)

    def rows(self, q: Array, q_s: Array, q_ss: Array) -> Array:
        """Rows (m, n, 4): torque = a s_ddot + b s_dot^2 + c at positions of a path, (m, n), over its limit.

        As in `fastest_speeds`, with a = M q', b = M q'' + C(q, q') q' and c = gravity (Bobrow, Dubowsky
        and Gibson 1985).
        """
        rows = np.zeros((*q.shape, 4))
        if self._dynamics is not None:
            _fill_rows(self._dynamics.arrays, q, q_s, q_ss, self._effort, rows)
            return rows
        still = np.zeros(q.shape[1])
        for row, position, first, second in zip(rows, q, q_s, q_ss, strict=True):
            rest = self._robot.rigid_dynamics(position, still, still)[2]
            tau, M, _ = self._robot.rigid_dynamics(position, first, second)
            row[:, :3] = np.column_stack([M @ first, tau - rest, rest]) / self._effort[:, None]
        return rows

    def use(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """The largest use of a limit in every state, (m,)."""
        use = np.empty(q.shape)
        if self._dynamics is not None:
            _fill_use(self._dynamics.arrays, q, q_dot, q_ddot, self._effort, use)
        else:
            model = self._robot.rigid_dynamics_model
            tau = np.array([model.torques(*state) for state in zip(q, q_dot, q_ddot, strict=True)])
            use = np.abs(tau / self._effort)
        return np.asarray(use.max(axis=1))

    def too_heavy(self, fraction: float, q: Array) -> PlanningError:
        """The error for joint positions q (n,), at a fraction of a path, that gravity does not permit."""
        still = np.zeros(len(q))
        tau = self._robot.rigid_dynamics(q, still, still)[2]
        axis = int(np.argmax(np.abs(tau / self._effort)))
        axes = self._robot.axes_data
        unit = axes.unit(axis, 'torque')
        return PlanningError(
            f'{axes.names[axis]} cannot hold the robot at {100.0 * fraction:.1f} % of the path: gravity asks '
            f'for {abs(tau[axis]):.6g} {unit}, its limit is {self._effort[axis]:.6g} {unit}; choose another '
            'path or configuration',
            fraction=fraction,
            joint=axes.names[axis],
            value=float(tau[axis]),
            bound=float(self._effort[axis]),
            unit=unit,
        )


@compiled()
def _fill_rows(
    dynamics: DynamicsArrays, q: Array, q_s: Array, q_ss: Array, effort: Array, rows: Array
) -> None:
    """Fill `TorqueLimits.rows`."""
    m, n = q.shape
    bodies, M, bias, weight = bodies_of(n), np.empty((n, n)), np.empty(n), np.empty(n)
    for i in range(m):
        fill_dynamics(dynamics, q[i], q_s[i], bodies, M, bias, weight)
        for j in range(n):
            first, second = 0.0, bias[j] - weight[j]
            for k in range(n):
                first += M[j, k] * q_s[i, k]
                second += M[j, k] * q_ss[i, k]
            rows[i, j, 0] = first / effort[j]
            rows[i, j, 1] = second / effort[j]
            rows[i, j, 2] = weight[j] / effort[j]


@compiled()
def _fill_use(
    dynamics: DynamicsArrays, q: Array, q_dot: Array, q_ddot: Array, effort: Array, use: Array
) -> None:
    """Fill use (m, n): torque over its limit."""
    m, n = q.shape
    bodies = bodies_of(n)
    for i in range(m):
        fill_torques(dynamics, q[i], q_dot[i], q_ddot[i], bodies, use[i])
        for j in range(n):
            use[i, j] = abs(use[i, j]) / effort[j]
