"""JointPath: joint positions over a path coordinate, twice continuously differentiable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core.validation import Array
from robots_planning.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class JointPath:
    """Knots of q(s), s from 0 to 1, with the quintic through q, q' and q'' between them.

    Attributes:
        s: (k,), increasing from 0 to 1.
        q: (k, n), rad (m).
        q_s: (k, n), first derivative with respect to s.
        q_ss: (k, n), second derivative.
    """

    s: Array
    q: Array
    q_s: Array
    q_ss: Array

    def __post_init__(self) -> None:
        # The same interpolation as a trajectory's, with s in the place of time.
        object.__setattr__(self, '_curve', Trajectory(self.s, self.q, self.q_s, self.q_ss))

    def evaluate(self, s: Array) -> tuple[Array, Array, Array]:
        """q, q' and q'' at `s` (m,), each (m, n)."""
        curve: Trajectory = self._curve  # type: ignore[attr-defined]
        return curve.sample(np.clip(s, 0.0, 1.0))
