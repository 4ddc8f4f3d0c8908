"""TimedPath: a trajectory along a path, with the times at which it passes the points of the path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots_core.validation import Array
from robots_planning.timing.path_start import Smoothing
from robots_planning.trajectory import Trajectory

CLOSEST_SEAM = 2e-4  # s to the next point of the trajectory; shorter steps would magnify rounding of jerk


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
