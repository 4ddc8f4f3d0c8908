"""TwoPassTiming: motion along a path by the two-pass algorithm."""

import numpy as np

from robots_core.validation import Array, positive
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.timed_path import TooSlowError
from robots_planning.timing.two_pass_kernel import (
    PathLimits,
    Points,
    grid_of,
    jerk_window,
    timed_points,
)
from robots_planning.trajectory import Trajectory

SMOOTHING_SHARE = 0.005  # of the duration that smoothing may add
# Windows tried with jerk limits, relative to the one that the largest jump of acceleration needs: a shorter
# one costs less time everywhere but slows the motion down around that jump.
JERK_WINDOWS = (1.0, 0.7, 0.5, 0.35, 0.2)


class TwoPassTiming:
    """The fastest motion along a path that keeps the limits of axes and tool, with continuous acceleration.

    A backward and a forward pass over the path speed hold velocity and acceleration limits on a grid; the
    time law is then smoothed, and slowed down where it would break a limit. With jerk limits the window of
    the smoothing follows from them.

    Args:
        velocity: Of the axes, (n,), rad/s (m/s).
        acceleration: rad/s^2 (m/s^2).
        jerk: rad/s^3 (m/s^3); None: acceleration is continuous, and jerk not limited.
        tool: Highest speed (m/s), acceleration, angular speed (rad/s) and angular acceleration of the tool,
            (4,), each on the norm of a vector; infinite for none.
        smoothing: Longest smoothing of acceleration without jerk limits, s.

    Raises:
        InvalidInputError: `smoothing` not above 0.
    """

    def __init__(
        self,
        velocity: Array,
        acceleration: Array,
        jerk: Array | None,
        tool: Array,
        *,
        smoothing: float,
    ) -> None:
        self._smoothing = positive(smoothing, 'smoothing', 's')
        self._jerk_limited = jerk is not None
        jerks = np.full(len(velocity), np.inf) if jerk is None else jerk
        self._limits: PathLimits = np.array([velocity, acceleration, jerks]), np.array(tool)

    def trajectory(
        self, joint_path: JointPath, tool_path: CartesianPath, longest: float = np.inf
    ) -> Trajectory:
        """The timed motion along a path; see `TimeOptimalTiming.timed`."""
        trajectory = self._trajectory(joint_path, tool_path)
        if trajectory.duration > longest:
            raise TooSlowError
        return trajectory

    def _trajectory(self, joint_path: JointPath, tool_path: CartesianPath) -> Trajectory:
        s, coefficients = joint_path.s, joint_path.coefficients
        grid = grid_of(s, coefficients, tool_path.arrays)

        def points(window: float, share: float) -> Points:
            return timed_points(s, coefficients, grid, self._limits, window, share)

        if not self._jerk_limited:
            return Trajectory(*points(self._smoothing, SMOOTHING_SHARE))
        window = jerk_window(grid, self._limits)
        plans = [points(part * window, np.inf) for part in JERK_WINDOWS]
        return Trajectory(*min(plans, key=lambda plan: float(plan[0][-1])))
