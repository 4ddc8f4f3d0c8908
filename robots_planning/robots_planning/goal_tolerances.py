"""GoalTolerances: how far a robot may be from the trajectory of a goal, on its path and at its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robots_core.validation import Array


@dataclass(frozen=True, eq=False)
class Tolerance:
    """Largest errors of the axes; infinite for any.

    Attributes:
        position: (n,), rad (m).
        velocity: (n,), rad/s (m/s).
    """

    position: Array
    velocity: Array

    @classmethod
    def none(cls, n: int) -> Tolerance:
        """Any error of n axes is tolerated."""
        return cls(np.full(n, np.inf), np.full(n, np.inf))

    def violation(self, q: Array, q_dot: Array, names: Sequence[str]) -> str:
        """What is violated by errors (n,) of positions and velocities, for a person; '' if nothing is."""
        for what, error, largest in (('position', q, self.position), ('velocity', q_dot, self.velocity)):
            over = np.flatnonzero(np.abs(error) > largest)
            if len(over):
                axis = int(over[0])
                return (
                    f'the {what} of {names[axis]} is {error[axis]:.6g} from its reference, allowed is '
                    f'{largest[axis]:.6g}'
                )
        return ''

    @property
    def given(self) -> bool:
        """It limits a position."""
        return bool(np.isfinite(self.position).any())


@dataclass(frozen=True)
class GoalTolerances:
    """Those of a goal.

    Attributes:
        path: While it moves.
        goal: At its end.
        goal_time: How long after the end of the reference the robot may take to be there, s; 0 for any time.
    """

    path: Tolerance
    goal: Tolerance
    goal_time: float

    def too_late(self, since_end: float) -> str:
        """Why a robot should be there, so long (s) after the end of the reference; '' if it need not."""
        if self.goal_time <= 0.0 or since_end <= self.goal_time:
            return ''
        return (
            f'the robot is not at its goal {since_end:.3g} s after its reference, allowed is '
            f'{self.goal_time:g} s'
        )
