"""Span: periods in which the controller continues as before, and nothing else happens."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core.validation import Array


@dataclass(frozen=True, eq=False)
class Span:
    """What `Controller.step` would give in the next k periods, to the last bit.

    Attributes:
        references: (k, 3, n): position, velocity, acceleration.
        progress: Done part of the path after each period, (k,), 0..1; 1 if none is followed.
        path_times: Of the motion after each period, (k,) s; empty if none is followed.
        samples: Of its path, which the references average, (k, 3, n); empty if none is followed.
    """

    references: Array
    progress: Array
    path_times: Array
    samples: Array

    @classmethod
    def standing(cls, reference: Array, periods: int) -> Span:
        """Periods of a robot that stands at a reference, (3, n)."""
        nothing = np.empty(0)
        return cls(np.repeat(reference[None], periods, axis=0), np.ones(periods), nothing, nothing)

    def __len__(self) -> int:
        return len(self.references)

    def first(self, periods: int) -> Span:
        """The first of its periods."""
        return Span(
            self.references[:periods],
            self.progress[:periods],
            self.path_times[:periods],
            self.samples[:periods],
        )
