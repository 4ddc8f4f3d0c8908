"""ReferenceUse: how much of the axes' limits the references of a controller use."""

from __future__ import annotations

from typing import Final

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.limit_use import LimitUse
from robots_planning.trajectory import Trajectory

QUANTITIES: Final = ('position', 'velocity', 'acceleration', 'torque')
UNITS: Final = {'position': '', 'velocity': '/s', 'acceleration': '/s^2'}


class ReferenceUse:
    """Compares references with the limits, as values and as steps from one to the next.

    What a drive makes of the time between two references is its own business: an interpolation that knows
    nothing of the steps of acceleration in between may pass a limit that is kept by all values and steps.

    Args:
        robot: Whose limits hold.
        trajectory: The references; no acceleration is made of steps over a gap.
        period: Between two references, s.
    """

    def __init__(self, robot: BaseRobotModel, trajectory: Trajectory, period: float) -> None:
        self._robot, self._trajectory = robot, trajectory
        step = np.diff(trajectory.time)[:, None]
        whole = step < 1.5 * period
        rate = np.diff(trajectory.position, axis=0) / step
        change = np.diff(rate, axis=0) / period * (whole[1:] & whole[:-1])
        self._velocity = np.maximum(np.abs(trajectory.velocity), np.abs(_late(rate)))
        self._acceleration = np.maximum(np.abs(trajectory.acceleration), np.abs(_late(_late(change))))

    def worst(self, first: int, last: int) -> dict[str, LimitUse]:
        """The worst use of every limit from one reference to another, both included; times from the first."""
        axes, trajectory = self._robot.axes_data, self._trajectory
        rows = slice(first, last + 1)
        time = trajectory.time[rows] - trajectory.time[first]
        q = trajectory.position[rows]
        bounded = np.isfinite(axes.lower) & np.isfinite(axes.upper)
        half = 0.5 * (axes.upper - axes.lower)
        middle = np.where(bounded, axes.lower + np.where(bounded, half, 0.0), 0.0)
        uses = {
            'position': self._use(
                'position', time, q, np.abs(q - middle) / half, np.where(q < middle, axes.lower, axes.upper)
            )
        }
        for quantity, values, limit in (
            ('velocity', self._velocity[rows], axes.velocity),
            ('acceleration', self._acceleration[rows], axes.acceleration),
            ('torque', self._torques(rows), axes.effort),
        ):
            uses[quantity] = self._use(quantity, time, values, values / limit, limit)
        return uses

    def _torques(self, rows: slice) -> Array:
        trajectory, model = self._trajectory, self._robot.rigid_dynamics_model
        states = zip(
            trajectory.position[rows], trajectory.velocity[rows], trajectory.acceleration[rows], strict=True
        )
        return np.abs([model.torques(*state) for state in states])

    def _use(self, quantity: str, time: Array, value: Array, ratio: Array, limit: Array) -> LimitUse:
        row, axis = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
        axes = self._robot.axes_data
        force = 'N' if axes.prismatic[axis] else 'N m'
        return LimitUse(
            quantity=quantity,
            ratio=float(ratio[row, axis]),
            joint=axes.names[axis],
            time=float(time[row]),
            value=float(value[row, axis]),
            limit=float(np.broadcast_to(limit, ratio.shape)[row, axis]),
            unit=force if quantity == 'torque' else axes.unit(int(axis)) + UNITS[quantity],
        )


def _late(values: Array) -> Array:
    """Values of steps, told at the reference that ends each."""
    return np.concatenate([np.zeros((1, values.shape[1])), values])
