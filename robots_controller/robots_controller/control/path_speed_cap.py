"""PathSpeedCap: the highest speed on a path at each place of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from robots_core.validation import Array

# Of the deceleration that the limits permit: the rest is for the difference between nodes and periods.
BRAKING: Final = 0.8


@dataclass(frozen=True, eq=False)
class PathSpeedCap:
    """Path speeds from which the speed can still be lowered in time to what is allowed ahead.

    Attributes:
        times: Path times of the nodes, (m,), s.
        allowed: Path speed allowed there, (m,), above 0 to 1.
        braking: Largest decrease of the path speed there, (m,), 1/s.
        speed: The cap, (m,); linear in between.
    """

    times: Array
    allowed: Array
    braking: Array
    speed: Array

    @classmethod
    def of(
        cls,
        times: Array,
        allowed: Array,
        derivatives: tuple[Array, Array],
        acceleration: Array,
        ramp_time: float,
    ) -> PathSpeedCap:
        """The cap on a path.

        Args:
            times: Path times of the nodes, (m,), s.
            allowed: Path speed allowed between two nodes, (m - 1,).
            derivatives: First and second derivative of the path at the nodes, (m, n) each.
            acceleration: Limits of the axes, (n,), rad/s^2.
            ramp_time: Shortest time in which the path speed falls from 1 to 0, s.
        """
        nodes = np.minimum(np.append(allowed, 1.0), np.append(1.0, allowed))
        q_s, q_ss = derivatives
        # |q'' speed^2 - q' braking| <= acceleration, for each axis.
        slack = acceleration + np.sign(q_s) * q_ss * nodes[:, None] ** 2
        largest = (slack / np.maximum(np.abs(q_s), 1e-9)).min(axis=1)
        braking = BRAKING * np.clip(largest, 0.0, 1.0 / ramp_time)
        return cls(times, nodes, braking, _viable(times, nodes, braking, 1.0))

    def at(self, path_time: float, period: float) -> float:
        """The cap for the next period (s) from a path time (s) on."""
        here = float(np.interp(path_time, self.times, self.speed))
        return min(here, float(np.interp(path_time + here * period, self.times, self.speed)))

    def ending(self, path_time: float, speed: float) -> PathSpeedCap:
        """The cap if the path is left at a path time (s) for one whose cap begins with this speed."""
        keep = int(np.searchsorted(self.times, path_time)) + 1
        times, allowed, braking = self.times[:keep], self.allowed[:keep], self.braking[:keep]
        return replace(
            self,
            times=times,
            allowed=allowed,
            braking=braking,
            speed=_viable(times, allowed, braking, speed),
        )


def _viable(times: Array, allowed: Array, braking: Array, end: float) -> Array:
    """The highest speeds from which `allowed` is kept to the end with this braking."""
    found = allowed.tolist()
    found[-1] = min(found[-1], end)
    steps = (2.0 * np.diff(times) * np.minimum(braking[:-1], braking[1:])).tolist()
    for k in range(len(found) - 2, -1, -1):
        found[k] = min(found[k], math.sqrt(found[k + 1] ** 2 + steps[k]))
    return np.array(found)
