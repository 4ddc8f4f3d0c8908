"""JointPath: joint positions over a path coordinate, twice continuously differentiable."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.validation import Array
from robots_planning.timing.quintic import quintic_coefficients, quintics_at


@dataclass(frozen=True, eq=False)
class JointPath:
    """Samples of q(s), s from 0 to 1, joined by quintics that match q, q' and q'' at them.

    Attributes:
        s: (k,), increasing from 0 to 1; k >= 2.
        q: (k, n), rad (m).
        q_s: (k, n), first derivative with respect to s.
        q_ss: (k, n), second derivative.
        seams: (j,), s where the third derivative jumps, as at the ends of a blend; trajectories have a point
            there. Empty by default.

    Raises:
        InvalidInputError: shapes that do not match, values that are not finite, or s that does not increase
            from 0 to 1.
    """

    s: Array
    q: Array
    q_s: Array
    q_ss: Array
    seams: Array = field(default_factory=lambda: np.empty(0))
    coefficients: Array = field(init=False, repr=False)
    """(k - 1, 6, n): polynomial per interval, in powers of s - s of the interval's start."""

    def __post_init__(self) -> None:
        for name in ('s', 'q', 'q_s', 'q_ss', 'seams'):
            values = np.ascontiguousarray(getattr(self, name), dtype=np.float64)
            # A sum is not finite if one of the values is not.
            if not np.isfinite(values.sum()):
                raise InvalidInputError(f'joint path {name} holds a value that is not finite')
            object.__setattr__(self, name, values)
        k = len(self.s)
        if self.s.ndim != 1 or k < 2 or self.q.ndim != 2 or len(self.q) != k:
            raise InvalidInputError(
                f'a joint path needs k >= 2 values s and (k, n) positions, got {self.s.shape} and '
                f'{self.q.shape}'
            )
        if self.q_s.shape != self.q.shape or self.q_ss.shape != self.q.shape:
            raise InvalidInputError(
                f'q {self.q.shape}, q_s {self.q_s.shape} and q_ss {self.q_ss.shape} must have one shape'
            )
        if self.s[0] != 0.0 or self.s[-1] != 1.0 or not (self.s[1:] > self.s[:-1]).all():
            raise InvalidInputError(
                's of a joint path must go from 0 to 1 and increase from sample to sample'
            )
        coefficients = np.empty((k - 1, 6, self.q.shape[1]))
        quintic_coefficients(self.s, self.q, self.q_s, self.q_ss, coefficients)
        object.__setattr__(self, 'coefficients', coefficients)

    @property
    def num_axes(self) -> int:
        """Number of axes n."""
        return int(self.q.shape[1])

    @property
    def samples(self) -> tuple[Array, Array, Array, Array]:
        """s, q, q' and q'', as compiled code takes them."""
        return self.s, self.q, self.q_s, self.q_ss

    def rest(self, s: float) -> JointPath:
        """What is left of the path from `s` on, with its own s from 0 to 1."""
        length = 1.0 - s
        first = self.evaluate(np.array([s]))
        left = self.s > s
        q, q_s, q_ss = (
            np.concatenate(parts)
            for parts in zip(first, (part[left] for part in self.samples[1:]), strict=True)
        )
        places, seams = ((part[part > s] - s) / length for part in (self.s, self.seams))
        return JointPath(np.append(0.0, places), q, q_s * length, q_ss * length**2, seams)

    def evaluate(self, s: Array) -> tuple[Array, Array, Array]:
        """q, q' and q'' at `s` (m,), clipped to [0, 1], each (m, n)."""
        values = np.ascontiguousarray(s, dtype=np.float64)
        q, q_s, q_ss = (np.empty((len(values), self.num_axes)) for _ in range(3))
        quintics_at(self.s, self.coefficients, values, q, q_s, q_ss)
        return q, q_s, q_ss
