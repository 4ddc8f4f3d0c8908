"""DriverDrives and DriverStop: a real robot behind a driver that follows short trajectories."""

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, finite_vector

SHORTEST: Final = 1e-6  # s, of braking; messages have nanoseconds


def stopping_trajectory(
    q: Array, q_dot: Array, axes: AxesData, lead: float
) -> list[tuple[float, Array, Array]]:
    """The trajectory that reaches a reference after `lead` and stops within the acceleration limits.

    A driver accepts it by itself, because it ends at rest, and stops the robot by it if no other one follows.
    Between the points a spline of the third order brakes with constant decelerations.

    Args:
        q: Reference positions, (n,), rad (m).
        q_dot: Reference velocities, (n,), rad/s (m/s).
        axes: The robot's limits.
        lead: Time in which the robot is to be there, s.

    Returns:
        One or two points: time from the start, s, positions and velocities (n,), zero at the last.
    """
    still = np.zeros_like(q_dot)
    braking = float((np.abs(q_dot) / axes.acceleration).max())
    if braking < SHORTEST:
        return [(lead, q, still)]
    end = np.clip(q + 0.5 * braking * q_dot, axes.lower, axes.upper)
    return [(lead, q, q_dot), (lead + braking, end, still)]


class DriverDrives(DriveTrain):
    """Drives that another process moves: it sets `position`, and what they are to do is in `command`.

    Args:
        position: Where the axes are, (n,), rad (m).
    """

    def __init__(self, position: Array) -> None:
        self.position, self.velocity = position, np.zeros_like(position)
        self.command: tuple[Array, Array] | None = None
        """Reference of this period: positions and velocities (n,); None for none."""

    def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
        """See `DriveTrain`; the velocity is that of the reference."""
        n = self.position.size
        self.velocity = np.zeros(n) if q_dot_ref is None else finite_vector(q_dot_ref, n, 'q_dot_ref')
        self.command = finite_vector(q_ref, n, 'q_ref'), self.velocity
        return self.position, self.velocity

    def rest(self) -> None:
        """See `DriveTrain`."""
        super().rest()
        self.command = None


FAILURE_SHOWN: Final = 1.0  # s, at least, that the robot is reported to have stopped


class DriverStop:
    """The driver's own state, and goals that it does not follow.

    A goal that fails is a stop of the robot until its brakes have closed, and for `FAILURE_SHOWN` at least.
    """

    follows = True
    """The driver says that its robot runs."""
    failure = ''
    """Why a goal has failed; '' if none has."""

    def __init__(self) -> None:
        self._failed_at = -math.inf

    @property
    def reason(self) -> str:
        """Why the robot has stopped; '' if it has not."""
        return self.failure or ('' if self.follows else 'the robot has stopped by itself')

    def fail(self, reason: str, now: float) -> bool:
        """A goal has failed, at a time in s; returns whether that is new."""
        new, self.failure, self._failed_at = reason != self.failure, reason, now
        return new

    def recover(self, now: float, *, braked: bool) -> bool:
        """End a failure that was shown long enough, if the brakes have closed; returns whether one ended."""
        if not (self.failure and braked and now - self._failed_at > FAILURE_SHOWN):
            return False
        self.failure = ''
        return True
