"""Redundancy: a secondary criterion for the degrees of freedom that the pose of the tool leaves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.kernels.compiled import compiled
from robots_core.kernels.small_matrices import damped_gram, solve_lower, solve_transposed
from robots_core.kernels.vectors import cross, dot, row_of
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, finite_vector, read_only

NO_CRITERION: Final = 0
PREFERRED_POSITIONS: Final = 1
LIMITS: Final = 2
MANIPULABILITY: Final = 3
# Regularisation of squared singular values, which keeps the measure finite in a singularity.
REGULARISATION: Final = 1e-4
POSE_SIZE: Final = 6
MANIPULABILITY_STEP: Final = 0.3  # rad, for a change of the measure by a factor e per radian

RedundancyArrays = tuple[int, Array, Array]
"""Kind, preferred joint positions and weights of a `Redundancy`."""


@dataclass(frozen=True, eq=False)
class Redundancy:
    """A secondary criterion in the null space of the pose. Create one by a class method.

    Attributes:
        kind: One of PREFERRED_POSITIONS, LIMITS, MANIPULABILITY.
        preferred: Preferred joint positions, (n,) rad (m); empty for the other kinds.
        weights: Of the axes then, (n,), 0..1; empty for 1 of all.
    """

    kind: int
    preferred: Array = field(default_factory=lambda: np.empty(0))
    weights: Array = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        for name in ('preferred', 'weights'):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @classmethod
    def near(cls, q: ArrayLike, weights: ArrayLike = ()) -> Redundancy:
        """Stay near joint positions `q`, (n,) rad (m); axes with a weight of 0 go where they may."""
        return cls(PREFERRED_POSITIONS, np.asarray(q, dtype=np.float64), np.asarray(weights, np.float64))

    @classmethod
    def sliding(cls, axes: AxesData, q: ArrayLike) -> Redundancy | None:
        """Let sliding axes carry the others, which stay near `q`; None for a robot with none to spare."""
        turning = ~np.array(axes.prismatic)
        return cls.near(q, turning) if turning.size > POSE_SIZE and not turning.all() else None

    @classmethod
    def away_from_limits(cls) -> Redundancy:
        """Stay near the middle of the axes' ranges, each weighted by its range (Liegeois 1977)."""
        return cls(LIMITS)

    @classmethod
    def manipulability(cls) -> Redundancy:
        """Stay away from singularities: ascend the gradient of log sqrt(det(J J^T)) (Yoshikawa 1985)."""
        return cls(MANIPULABILITY)


def redundancy_arrays(redundancy: Redundancy | None, axes: AxesData) -> RedundancyArrays:
    """Arrays for compiled code; without a criterion all weights are 0.

    Raises:
        JointLimitError: the preferred positions lie outside the limits.
        InvalidInputError: they, or the weights, have another shape or are not finite.
    """
    n = axes.num_axes
    preferred, weights = np.zeros(n), np.ones(n)
    if redundancy is None:
        return NO_CRITERION, preferred, np.zeros(n)
    if redundancy.kind == PREFERRED_POSITIONS:
        preferred = axes.check_position(redundancy.preferred, 'preferred')
        if redundancy.weights.size:
            weights = finite_vector(redundancy.weights, n, 'weights')
    elif redundancy.kind == LIMITS:
        preferred, half = axes.middle_and_half
        weights = np.zeros(n) if np.isinf(half).all() else (half.min() / half) ** 2
    # Copies can be written to, as the arrays without a criterion: for others all would be compiled again.
    return redundancy.kind, np.array(preferred), np.array(weights)


@compiled()
def desired_displacement(redundancy: RedundancyArrays, q: Array, J: Array, desired: Array) -> None:
    """Fill the joint displacement, (n,) rad (m), that a criterion demands at `q`."""
    kind, preferred, weights = redundancy
    n = q.size
    if kind == NO_CRITERION:
        desired[:] = 0.0
    elif kind == MANIPULABILITY:
        _manipulability_gradient(J, desired)
        for i in range(n):
            desired[i] *= MANIPULABILITY_STEP
    else:
        for i in range(n):
            desired[i] = weights[i] * (preferred[i] - q[i])


@compiled()
def _manipulability_gradient(J: Array, gradient: Array) -> None:
    """Gradient of log sqrt(det(J J^T)) = trace(J^+ dJ/dq_k), with dJ/dq_k from the columns of J."""
    n = J.shape[1]
    L, G = np.empty((6, 6)), J.T.copy()
    damped_gram(J, REGULARISATION, L)
    for k in range(n):
        solve_lower(L, G[k])
        solve_transposed(L, G[k])
    for k in range(n):
        value = 0.0
        for i in range(n):
            # The axis nearer to the base rotates the column of the other.
            first, second = (k, i) if k <= i else (i, k)
            omega = (J[3, first], J[4, first], J[5, first])
            linear = cross(omega, (J[0, second], J[1, second], J[2, second]))
            value += dot(row_of(G, i), linear)
            if k < i:
                value += dot((G[i, 3], G[i, 4], G[i, 5]), cross(omega, (J[3, i], J[4, i], J[5, i])))
        gradient[k] = value
