"""Tolerance: how far a robot may be from the trajectory of a goal, on its path or at its end."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.errors import InvalidInputError, JointNamesError
from robots_core.validation import Array

UNLIMITED: Final = -1.0  # as in control_msgs


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

    @classmethod
    def wanted(cls, of: Iterable[tuple[str, float, float]], names: Sequence[str], what: str) -> Tolerance:
        """Those of a client: 0 and -1 are none, as far as ours go.

        Args:
            of: Name of a joint, and the largest errors of its position and its velocity.
            names: All joints.
            what: For messages.

        Raises:
            JointNamesError: a joint that the robot does not have.
            InvalidInputError: a tolerance below 0 that is not -1, or none at all.
        """
        tolerance = cls.none(len(names))
        for name, position, velocity in of:
            if name not in names:
                raise JointNamesError(f'{what} of {name!r}; the joints are {", ".join(names)}')
            for values, value in ((tolerance.position, position), (tolerance.velocity, velocity)):
                if not (value >= 0.0 or value == UNLIMITED):
                    raise InvalidInputError(
                        f'{what} of {name} is {value:g}; valid are numbers from 0 on, and -1 for none'
                    )
                values[names.index(name)] = value if value > 0.0 else np.inf
        return tolerance

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
