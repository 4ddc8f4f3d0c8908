"""TrajectoryGoal: when a goal of FollowJointTrajectory is given up, and how it has ended."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, JointNamesError
from robots_core.validation import Array
from robots_planning.commands.goal_outcome import (
    GOAL_TOLERANCE_VIOLATED,
    PATH_TOLERANCE_VIOLATED,
    SUCCESSFUL,
    Outcome,
)

UNLIMITED: Final = -1.0  # as in control_msgs
AT_TARGET: Final = 1e-9  # rad (m), of references, which end there but for rounding


Errors: TypeAlias = tuple[Array, Array]
"""Reference without what is measured: positions (n,), rad (m), and velocities (n,), rad/s (m/s)."""


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


class TrajectoryGoal:
    """A goal under way.

    Args:
        names: Of the joints.
        path: Tolerances while it moves.
        goal: Tolerances at its end.
        goal_time: How long after the end of the reference the robot may take to be there, s; 0 for any time.
    """

    def __init__(self, names: Sequence[str], path: Tolerance, goal: Tolerance, goal_time: float) -> None:
        self._names, self._path, self._goal, self._goal_time = names, path, goal, goal_time
        self.target: Array | None = None
        """The end of its trajectory, (n,), rad (m); None before there is one."""
        self._at_end = math.inf  # s, since when the reference stands at the target

    def check(self, q: Array, errors: Errors, now: float) -> Outcome | None:
        """Why it is given up at a time, s, with the reference at `q`, (n,), rad (m); None if it is not."""
        if violation := self._path.violation(*errors, self._names):
            return Outcome(PATH_TOLERANCE_VIOLATED, violation)
        if self.target is None or np.abs(q - self.target).max() > AT_TARGET:
            return None
        self._at_end = min(self._at_end, now)
        late = now - self._at_end
        if not 0.0 < self._goal_time < late:
            return None
        text = (
            f'the robot is not at its goal {late:.3g} s after its reference, allowed is {self._goal_time:g} s'
        )
        return Outcome(GOAL_TOLERANCE_VIOLATED, text)

    def outcome(self, result: MotionResult, errors: Errors | None) -> Outcome:
        """Its outcome, by the result of its motion; the goal's tolerances decide at the end of its path."""
        if not result.ok and float(result.details.get('progress', 0.0)) < 1.0:
            return Outcome(PATH_TOLERANCE_VIOLATED, result.message)
        violation = '' if errors is None else self._goal.violation(*errors, self._names)
        tolerated = errors is not None and self._goal.given
        if violation or not (result.ok or tolerated):
            return Outcome(GOAL_TOLERANCE_VIOLATED, violation or result.message)
        return Outcome(SUCCESSFUL, result.message)
