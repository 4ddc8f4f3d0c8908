"""ConstrainedStep: one step of the constrained inverse kinematics, and its active limits."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from robots_core.validation import Array

Quantity = Literal['position', 'velocity', 'acceleration', 'torque']
QUANTITIES: dict[int, Quantity] = {1: 'position', 2: 'velocity', 3: 'acceleration'}


@dataclass(frozen=True)
class ActiveLimit:
    """A limit that kept the robot from following more closely.

    Attributes:
        joint: The axis' name.
        quantity: The limited quantity; 'position' also while the axis brakes for its position limit.
        side: The end of the range.
    """

    joint: str
    quantity: Quantity
    side: Literal['lower', 'upper']


@dataclass(frozen=True, eq=False, slots=True)
class ConstrainedStep:
    """Joint motion of one period with constant acceleration, with errors and slacks.

    Attributes:
        values: (4, n), read-only: the rows `q`, `q_dot`, `q_ddot`, `torque`.
        slack: By how much a limit of positions, velocities or torques is or will be broken at most, relative
            to it (positions: to the range); 0 unless the step began in a state from which it cannot be kept.
        position_error: Distance to the reference at the end of the period, m.
        orientation_error: Angle to the reference at the end of the period, rad.
        solved: False if the quadratic program did not converge; the robot then brakes.
        active: (2, n): per axis what bounds its velocity (1 position, 2 velocity, 3 acceleration) and whether
            its torque is bounded (1); the sign is the side, 0 nothing.
        names: Of the axes.
    """

    values: Array
    slack: float
    position_error: float
    orientation_error: float
    solved: bool
    active: NDArray[np.int64]
    names: tuple[str, ...]

    @property
    def active_limits(self) -> tuple[ActiveLimit, ...]:
        """Active limits, which cost accuracy."""
        found: list[ActiveLimit] = []
        for name, bound, torque in zip(self.names, *self.active.tolist(), strict=True):
            if bound:
                found.append(ActiveLimit(name, QUANTITIES[abs(bound)], 'upper' if bound > 0 else 'lower'))
            if torque:
                found.append(ActiveLimit(name, 'torque', 'upper' if torque > 0 else 'lower'))
        return tuple(found)

    @property
    def q(self) -> Array:
        """Joint positions at the end of the period, (n,), rad (m)."""
        return np.asarray(self.values[0])

    @property
    def q_dot(self) -> Array:
        """Joint velocities at the end of the period, (n,), rad/s."""
        return np.asarray(self.values[1])

    @property
    def q_ddot(self) -> Array:
        """Joint accelerations during the period, (n,), rad/s^2."""
        return np.asarray(self.values[2])

    @property
    def torque(self) -> Array:
        """Torques at the start of the period, M q_ddot + tau_aux, (n,), N m."""
        return np.asarray(self.values[3])
