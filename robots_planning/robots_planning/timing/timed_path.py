"""TimedPath: a trajectory along a path, and how another one begins that continues from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.paths.reparametrised_path import ReparametrisedPath
from robots_planning.trajectory import Trajectory

CLOSEST_SEAM = 2e-4  # s to the next point of the trajectory; shorter steps would magnify rounding of jerk


@dataclass(frozen=True)
class Smoothing:
    """How a time law was made smooth.

    Attributes:
        window: Over which it was averaged, s.
        stretch: Factor on its time after that.
    """

    window: float
    stretch: float


@dataclass(frozen=True, eq=False)
class TimedPath:
    """A trajectory along a path.

    Attributes:
        trajectory: The trajectory.
        s: Path coordinate at each of its points, (m,), from 0 to 1.
        smoothing: Of its time law.
    """

    trajectory: Trajectory
    s: Array
    smoothing: Smoothing

    def times_of(self, s: Array) -> Array:
        """Times, s, at which the path coordinate has the values `s` (k,); exact at seams of the path."""
        return np.asarray(np.interp(s, self.s, self.trajectory.time))


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


def with_times(times: Array, others: Array) -> Array:
    """Increasing times merged with others; times that nearly coincide with one of the others are left out."""
    inner = others[(others > times[0] + CLOSEST_SEAM) & (others < times[-1] - CLOSEST_SEAM)]
    bounds = np.concatenate([[-np.inf], inner, [np.inf]])
    after = np.searchsorted(inner, times) + 1
    distance = np.minimum(times - bounds[after - 1], bounds[after] - times)
    return np.union1d(times[distance > CLOSEST_SEAM], inner)


def slower(trajectory: Trajectory, use: float) -> Trajectory:
    """The same motion in the time in which the largest use of a limit, `use`, is 1."""
    if use <= 1.0:
        return trajectory
    t = Trajectory.message_times(trajectory.time * use)
    # Rounded times shift the points along the motion; see `message_times`.
    q, q_dot, q_ddot = trajectory.sample(t / use)
    q[[0, -1]] = trajectory.position[[0, -1]]
    q_dot[[0, -1]], q_ddot[[0, -1]] = trajectory.velocity[[0, -1]], trajectory.acceleration[[0, -1]]
    return Trajectory(t, q, q_dot / use, q_ddot / use**2)
