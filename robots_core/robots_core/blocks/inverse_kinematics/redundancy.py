"""Redundancy: what a robot does with the freedom that the pose of its tool leaves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.robot_model.analytic.compiled import compiled
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, read_only

NO_CRITERION: Final = 0
POSTURE: Final = 1
LIMITS: Final = 2
MANIPULABILITY: Final = 3
# Squared singular values below this count as this much: the measure stays finite in a singularity.
REGULARISATION: Final = 1e-4
MANIPULABILITY_STEP: Final = 0.3  # rad, for a change of the measure by a factor e per radian

RedundancyArrays = tuple[int, Array, Array]
"""Kind, posture and pull of a `Redundancy`."""


@dataclass(frozen=True, eq=False)
class Redundancy:
    """A sub-criterion, weaker than the pose whatever its size. Make one by a class method.

    Attributes:
        kind: One of POSTURE, LIMITS, MANIPULABILITY.
        posture: Where to stay, (n,) rad (m); empty but for POSTURE.
    """

    kind: int
    posture: Array = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        object.__setattr__(self, 'posture', read_only(self.posture))

    @classmethod
    def near(cls, posture: ArrayLike) -> Redundancy:
        """Stay near a posture, (n,) rad (m)."""
        return cls(POSTURE, np.asarray(posture, dtype=np.float64))

    @classmethod
    def away_from_limits(cls) -> Redundancy:
        """Stay in the middle of the ranges, each axis relative to its range (Liegeois 1977)."""
        return cls(LIMITS)

    @classmethod
    def manipulability(cls) -> Redundancy:
        """Stay away from singularities: climb the logarithm of sqrt(det(J J^T)) (Yoshikawa 1985)."""
        return cls(MANIPULABILITY)

    def target(self, axes: AxesData) -> tuple[Array, Array]:
        """Posture (n,) that the criterion pulls to, and the pull per axis (n,), 0..1, for compiled code.

        Raises:
            JointLimitError: the posture lies outside the limits.
            InvalidInputError: it has another shape or is not finite.
        """
        n = axes.num_axes
        if self.kind == POSTURE:
            return axes.check_position(self.posture, 'posture'), np.ones(n)
        if self.kind == LIMITS:
            middle = np.where(axes.continuous, 0.0, 0.5 * (axes.lower + axes.upper))
            width = np.where(axes.continuous, np.inf, axes.upper - axes.lower)
            if np.isinf(width).all():
                return middle, np.zeros(n)
            return middle, (width.min() / width) ** 2
        if self.kind == MANIPULABILITY:
            return np.zeros(n), np.ones(n)
        raise InvalidInputError(f'Redundancy.kind = {self.kind} is none of 1 (posture), 2 (limits), 3')


def redundancy_arrays(redundancy: Redundancy | None, axes: AxesData) -> RedundancyArrays:
    """Kind, posture and pull, as compiled code takes them; without a criterion nothing pulls."""
    if redundancy is None:
        return NO_CRITERION, np.zeros(axes.num_axes), np.zeros(axes.num_axes)
    posture, pull = redundancy.target(axes)
    return redundancy.kind, np.ascontiguousarray(posture), np.ascontiguousarray(pull)


@compiled()
def wanted_displacement(redundancy: RedundancyArrays, q: Array, J: Array, wanted: Array) -> None:
    """Fill the joint displacement, (n,) rad (m), that a criterion wants at `q`."""
    kind, posture, pull = redundancy
    n = q.size
    if kind == NO_CRITERION:
        wanted[:] = 0.0
    elif kind == MANIPULABILITY:
        _manipulability_gradient(J, wanted)
        for i in range(n):
            wanted[i] *= MANIPULABILITY_STEP
    else:
        for i in range(n):
            wanted[i] = pull[i] * (posture[i] - q[i])


@compiled()
def _manipulability_gradient(J: Array, gradient: Array) -> None:
    """Gradient of log sqrt(det(J J^T)) = trace(J^+ dJ/dq_k), with dJ/dq_k from the columns of J."""
    n = J.shape[1]
    A = J @ J.T
    for i in range(6):
        A[i, i] += REGULARISATION
    G = np.linalg.solve(A, J)
    for k in range(n):
        value = 0.0
        for i in range(n):
            # The axis that is nearer to the base turns the other's column.
            first, second = (k, i) if k <= i else (i, k)
            wx, wy, wz = J[3, first], J[4, first], J[5, first]
            vx, vy, vz = J[0, second], J[1, second], J[2, second]
            value += G[0, i] * (wy * vz - wz * vy) + G[1, i] * (wz * vx - wx * vz)
            value += G[2, i] * (wx * vy - wy * vx)
            if k < i:
                ax, ay, az = J[3, i], J[4, i], J[5, i]
                value += G[3, i] * (wy * az - wz * ay) + G[4, i] * (wz * ax - wx * az)
                value += G[5, i] * (wx * ay - wy * ax)
        gradient[k] = value
