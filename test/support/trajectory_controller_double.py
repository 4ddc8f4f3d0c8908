"""The joint_trajectory_controller of a driver, after its documentation of Jazzy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Point = tuple[float, Sequence[float], Sequence[float]]
"""Time from the start (s), positions, velocities."""


@dataclass(frozen=True)
class Segment:
    """A spline of the third order between two points, at times in s."""

    start: float
    end: float
    state: np.ndarray  # (2, n), at the start
    target: np.ndarray  # (2, n)

    def at(self, time: float) -> np.ndarray:
        """Positions and velocities, (2, n)."""
        length = self.end - self.start
        s = (time - self.start) / length
        (q0, v0), (q1, v1) = self.state, self.target
        c2 = 3.0 * (q1 - q0) - length * (2.0 * v0 + v1)
        c3 = -2.0 * (q1 - q0) + length * (v0 + v1)
        position = q0 + s * (length * v0 + s * (c2 + s * c3))
        return np.array([position, v0 + s * (2.0 * c2 + 3.0 * s * c3) / length])


class TrajectoryControllerDouble:
    """Follows the newest trajectory from its desired state, as with `interpolate_from_desired_state`.

    The robot is where it is to be.

    Args:
        names: Joints, n of them.
        position: Where they are, (n,).
    """

    def __init__(self, names: Sequence[str], position: np.ndarray) -> None:
        self.names = list(names)
        self.state = np.array([position, np.zeros_like(position)])
        self._segments: list[Segment] = []

    def put(self, now: float, names: Sequence[str], points: Sequence[Point], stamp: float = 0.0) -> str:
        """Take a trajectory at a time, s; returns why it is rejected, '' if it is accepted."""
        times = [time for time, _, _ in points]
        for refused, reason in (
            (list(names) != self.names, 'joints do not match'),
            (not points, 'empty'),
            (any(np.diff([0.0, *times]) <= 0.0), 'times do not increase'),
            (stamp and times and stamp + times[-1] < now, 'ends in the past'),
            (any(len(row) != len(self.names) for point in points for row in point[1:]), 'sizes do not match'),
            (points and np.any(points[-1][2]), 'velocity at the end is not zero'),
        ):
            if refused:
                return reason
        self.step(now)
        start, state = stamp or now, self.state
        self._segments = []
        for time, position, velocity in points:
            target = np.array([position, velocity], dtype=np.float64)
            begin = self._segments[-1].end if self._segments else now
            self._segments.append(Segment(begin, start + time, state, target))
            state = target
        return ''

    def stop(self, now: float) -> None:
        """Stand where the robot is from now on."""
        self.state = np.array([self.step(now)[0], np.zeros(len(self.names))])
        self._segments = []

    def step(self, now: float) -> np.ndarray:
        """The desired state at a time, (2, n), which the robot has."""
        for segment in self._segments:
            if now < segment.end:
                self.state = segment.at(now)
                return self.state
        if self._segments:
            self.state = self._segments[-1].target
        return self.state
