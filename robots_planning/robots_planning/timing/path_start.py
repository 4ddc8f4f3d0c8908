"""PathStart: how a motion begins that continues from another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.paths.reparametrised_path import ReparametrisedPath


@dataclass(frozen=True)
class Smoothing:
    """How a time law was made smooth.

    Attributes:
        window: Over which it was averaged, s.
        stretch: Factor on its time after that.
    """

    window: float
    stretch: float


@dataclass(frozen=True)
class PathStart:
    """Speed and acceleration along a path at its start.

    Attributes:
        s_dot: 1/s, above 0.
        s_ddot: 1/s^2.
        smoothing: Of the time law that it continues from.
    """

    s_dot: float
    s_ddot: float
    smoothing: Smoothing

    @classmethod
    def of(cls, path: JointPath, q_dot: Array, q_ddot: Array, smoothing: Smoothing) -> PathStart:
        """The start of a robot that moves along the path already.

        Args:
            path: The path.
            q_dot: Velocity at its start, (n,), rad/s (m/s); parallel to q'.
            q_ddot: Acceleration there, (n,), rad/s^2 (m/s^2).
            smoothing: Of the time law by which it moves.
        """
        first, second = path.q_s[0], path.q_ss[0]
        square = float(first @ first)
        s_dot = float(q_dot @ first) / square
        return cls(s_dot, float((q_ddot - second * s_dot**2) @ first) / square, smoothing)

    def over(self, path: ReparametrisedPath) -> PathStart:
        """The same start over the coordinate sigma of the path, and over time that is not stretched yet."""
        _, first, second = (float(values[0]) for values in path.s_of(np.zeros(1)))
        stretch = self.smoothing.stretch
        sigma_dot = stretch * self.s_dot / first
        sigma_ddot = (stretch**2 * self.s_ddot - second * sigma_dot**2) / first
        return PathStart(sigma_dot, sigma_ddot, self.smoothing)

    def before_average(self) -> tuple[float, float]:
        """S and s_dot of a law at constant acceleration whose average over the window begins like this."""
        window = self.smoothing.window
        speed = self.s_dot + 0.5 * window * self.s_ddot
        return 0.5 * window * speed - window**2 * self.s_ddot / 6.0, speed
