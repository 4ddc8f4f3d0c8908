"""PathSpeedCap: the highest speed on a path at each place of it."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.kernels.compiled import compiled
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

# Of the deceleration that the limits permit: the rest is for the difference between nodes and periods.
BRAKING: Final = 0.8
SLOWEST: Final = 1e-9  # rad/s (m/s); an axis that moves less does not hinder braking
SPACING: Final = 0.01  # s of a trajectory between two nodes


@dataclass(frozen=True, eq=False)
class PathSpeedCap:
    """Path speeds from which the speed can still be lowered in time to what is allowed ahead.

    With the path speed v, its square w = v^2 and the deceleration b = -dw/ds / 2, an axis whose acceleration
    limit is a keeps |q'' w - q' b| <= a as long as b <= (a + sign(q') q'' w) / |q'|.

    Attributes:
        times: Path times of the nodes, (m,), s.
        allowed: Squares of the path speeds allowed there, (m,), above 0 to 1.
        braking: a / |q'| and sign(q') q'' / |q'| at the nodes, (2, m, n).
        ramp: Largest decrease of the path speed, 1/s.
        squares: Squares of the cap, (m,); linear in between, as with a constant deceleration.
    """

    times: Array
    allowed: Array
    braking: Array
    ramp: float
    squares: Array

    @classmethod
    def of(
        cls, trajectory: Trajectory, acceleration: Array, ramp_time: float, allowed: ArrayLike = 1.0
    ) -> PathSpeedCap:
        """The cap on the path of a trajectory.

        Args:
            trajectory: The trajectory.
            acceleration: Limits of the axes, (n,), rad/s^2.
            ramp_time: Shortest time in which the path speed falls from 1 to 0, s.
            allowed: Path speed allowed between two of its `path_times`, (m - 1,); its own by default.
        """
        times = path_times(trajectory)
        speeds = np.broadcast_to(allowed, times.size - 1)
        nodes = np.minimum(np.append(speeds, 1.0), np.append(1.0, speeds)) ** 2
        _, q_s, q_ss = trajectory.sample(times)
        rates = np.maximum(np.abs(q_s), SLOWEST)
        braking = np.stack([acceleration / rates, np.sign(q_s) * q_ss / rates])
        ramp = 1.0 / ramp_time
        return cls(times, nodes, braking, ramp, _viable(times, nodes, braking, ramp, 1.0))

    @property
    def begin(self) -> float:
        """The cap at the path's start."""
        return sqrt(self.squares[0])

    def here(self, path_time: float) -> float:
        """The cap at a path time, s."""
        return sqrt(np.interp(path_time, self.times, self.squares))

    def at(self, path_time: float, period: float) -> float:
        """The cap for the next period (s) from a path time (s) on."""
        here = self.here(path_time)
        return min(here, self.here(path_time + here * period))

    def ending(self, path_time: float, speed: float) -> PathSpeedCap:
        """The cap if the path has to be left at a path time (s) with at most this speed."""
        last = int(np.searchsorted(self.times, path_time))
        before = max(min(last, self.times.size - 1) - 1, 0)
        after = min(before + 1, self.times.size - 1)
        span = self.times[after] - self.times[before]
        part = min(max((path_time - self.times[before]) / span, 0.0), 1.0) if span > 0.0 else 0.0
        braking = (1.0 - part) * self.braking[:, before] + part * self.braking[:, after]
        times = np.append(self.times[:last], path_time)
        allowed = np.append(self.allowed[:last], min(self.allowed[before], self.allowed[after]))
        braking = np.concatenate([self.braking[:, :last], braking[:, None]], axis=1)
        squares = _viable(times, allowed, braking, self.ramp, speed**2)
        return PathSpeedCap(times, allowed, braking, self.ramp, squares)


def path_times(trajectory: Trajectory) -> Array:
    """Nodes for a cap, (m,), s."""
    return np.linspace(0.0, trajectory.duration, max(1, ceil(trajectory.duration / SPACING)) + 1)


@compiled()
def _viable(times: Array, allowed: Array, braking: Array, ramp: float, end: float) -> Array:
    """The highest squares of speeds from which `allowed` is kept to the end with this braking."""
    squares = allowed.copy()
    squares[-1] = min(squares[-1], end)
    for k in range(times.size - 2, -1, -1):
        step = 2.0 * BRAKING * (times[k + 1] - times[k])
        highest = squares[k + 1] + step * ramp
        for node in (k, k + 1):
            for axis in range(braking.shape[2]):
                # The deceleration that is possible depends on the square at the interval's start itself.
                rest = 1.0 - step * braking[1, node, axis]
                if rest > 0.0:
                    highest = min(highest, (squares[k + 1] + step * braking[0, node, axis]) / rest)
        # To continue at the same speed is always possible.
        squares[k] = min(squares[k], max(highest, squares[k + 1]))
    return squares
