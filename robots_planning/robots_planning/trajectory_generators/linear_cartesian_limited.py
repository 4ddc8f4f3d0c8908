"""LinearCartesianLimited: point-to-point on a straight line of the tool, by the two-pass algorithm."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy.ndimage import maximum_filter1d

from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import TrajectoryGenerator, rest_trajectory
from robots_planning.trajectory_generators.cartesian_line import CartesianLine
from robots_planning.trajectory_generators.joint_path import JointPath
from robots_planning.trajectory_generators.line_inverse_kinematics import LineInverseKinematics
from robots_planning.trajectory_generators.time_law import TimeLaw
from robots_planning.trajectory_generators.two_pass import two_pass

SHORTEST_LENGTH = 1e-8  # m
SHORTEST_ANGLE = 1e-8  # rad
GRID = 200  # points of the speed profile over the line, at least
POINTS_PER_WINDOW = 8  # of the trajectory, so that its quintics follow the smoothed acceleration
CHECKS_PER_POINT = 4
STRETCH_EXCESS = 1e-6  # so that rounding does not ask for another round
ROUNDS = 4  # of lowering the limits where smoothing broke them
# Smoothing and interpolation move speeds to where the limits are slightly different.
SMOOTHING_MARGIN = 2e-3


class LinearCartesianLimited(TrajectoryGenerator):
    """The tool moves on a straight line and turns about one axis, as fast as axes and tool limits allow.

    A forward and a backward pass over the path speed hold the limits on a grid; the time law is then
    smoothed, so that acceleration is continuous, and slowed down where it would break an axis limit. Near a
    singularity the motion becomes slow. Axis jerk and torque are not limited.

    Args:
        robot: The robot.
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration limits to use, in (0, 1].
        cartesian_speed: Highest speed of the tool, m/s.
        cartesian_acceleration: Highest acceleration of the tool along the line, m/s^2.
        rotation_speed: Highest angular speed of the tool, rad/s.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2.
        smoothing: Width of the window that smooths the time law, s; the motion is longer by that much.

    Raises:
        InvalidInputError: a fraction outside (0, 1], or another option that is not above 0.
    """

    accepts_joints: ClassVar[bool] = False

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        speed_fraction: float = 1.0,
        acceleration_fraction: float = 1.0,
        cartesian_speed: float = 0.5,
        cartesian_acceleration: float = 2.0,
        rotation_speed: float = 1.5,
        rotation_acceleration: float = 6.0,
        smoothing: float = 0.06,
    ) -> None:
        super().__init__(robot, speed_fraction=speed_fraction, acceleration_fraction=acceleration_fraction)
        self.cartesian_speed = positive(cartesian_speed, 'cartesian_speed', 'm/s')
        self.cartesian_acceleration = positive(cartesian_acceleration, 'cartesian_acceleration', 'm/s^2')
        self.rotation_speed = positive(rotation_speed, 'rotation_speed', 'rad/s')
        self.rotation_acceleration = positive(rotation_acceleration, 'rotation_acceleration', 'rad/s^2')
        self.smoothing = positive(smoothing, 'smoothing', 's')

    def _plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        line = CartesianLine(Pose(*self.robot.direct_kinematics(start)), target)
        if line.length < SHORTEST_LENGTH and line.angle < SHORTEST_ANGLE:
            return rest_trajectory(start, start)
        path = self._follow(line, start)
        s = speed_grid(path.s)
        quantities = _Quantities(self, line, path, s)
        law = self._time_law(quantities)
        return self._trajectory(path, law, quantities)

    def _follow(self, line: CartesianLine, start: Array) -> JointPath:
        # A pose that no posture reaches is told as such, before the place where the line fails.
        try:
            return LineInverseKinematics(self.robot).follow(line, start)
        except PlanningError:
            self.reach(line.end, start)
            raise

    def _time_law(self, quantities: _Quantities) -> TimeLaw:
        scale = np.full(len(quantities.s), 1.0 - SMOOTHING_MARGIN)
        for _ in range(ROUNDS):
            law = quantities.time_law(scale, self.smoothing)
            t = trajectory_times(law.duration, self.smoothing)
            ratio = quantities.worst_ratio(law, t)
            if float(ratio.max()) <= 1.0:
                break
            # Slow down wherever a window reaches a time at which a limit is broken.
            reach = 2 * POINTS_PER_WINDOW + 1
            spread = maximum_filter1d(np.maximum(ratio, 1.0), reach)
            # A little more than needed, so that few rounds suffice.
            scale = scale / np.interp(law.grid_times(), t, spread) ** 1.1
        return law

    def _trajectory(self, path: JointPath, law: TimeLaw, quantities: _Quantities) -> Trajectory:
        """The trajectory of a time law, slowed down evenly until it keeps the limits everywhere."""
        stretch = max(quantities.largest_use(law, trajectory_times(law.duration, self.smoothing)), 1.0)
        for _ in range(ROUNDS):
            trajectory = sample_law(path, law, self.smoothing, stretch)
            use = self._largest_use(trajectory)
            if use <= 1.0:
                break
            stretch *= use * (1.0 + STRETCH_EXCESS)
        return trajectory

    def _largest_use(self, trajectory: Trajectory) -> float:
        """By which factor time must be stretched to hold all axis limits, between the points too."""
        fine = np.linspace(0.0, trajectory.duration, CHECKS_PER_POINT * (len(trajectory.time) - 1) + 1)
        _, q_dot, _ = trajectory.sample(fine)
        acceleration = float((trajectory.acceleration_extremes()[1] / self.acceleration).max())
        return max(float((np.abs(q_dot) / self.velocity).max()), float(np.sqrt(acceleration)))


class _Quantities:
    """Axes and tool motion over the path grid, each with a velocity and an acceleration limit."""

    def __init__(
        self, generator: LinearCartesianLimited, line: CartesianLine, path: JointPath, s: Array
    ) -> None:
        self.s = s
        self.path = path
        self._tool = np.array([line.length, line.angle])
        self._velocity = np.concatenate(
            [generator.velocity, [generator.cartesian_speed, generator.rotation_speed]]
        )
        self._acceleration = np.concatenate(
            [generator.acceleration, [generator.cartesian_acceleration, generator.rotation_acceleration]]
        )
        self._q_s, self._q_ss = self._derivatives(s)

    def _derivatives(self, s: Array) -> tuple[Array, Array]:
        _, q_s, q_ss = self.path.evaluate(s)
        tool = np.broadcast_to(self._tool, (len(s), 2))
        return np.concatenate([q_s, tool], axis=1), np.concatenate([q_ss, np.zeros_like(tool)], axis=1)

    def time_law(self, scale: Array, window: float) -> TimeLaw:
        """The fastest smooth time law with limits lowered to `scale` (m,) of themselves."""
        speed_squared = two_pass(
            self.s,
            self._q_s,
            self._q_ss,
            scale[:, None] ** 0.5 * self._velocity,
            scale[:, None] * self._acceleration,
        )
        return TimeLaw(self.s, speed_squared, window)

    def worst_ratio(self, law: TimeLaw, t: Array) -> Array:
        """Largest use of a limit at each time, (m,): acceleration, and velocity squared."""
        s, s_dot, s_ddot = law.s_of(t)
        q_s, q_ss = self._derivatives(s)
        velocity = np.abs(q_s) * (np.abs(s_dot)[:, None] / self._velocity)
        acceleration = np.abs(q_ss * (s_dot**2)[:, None] + q_s * s_ddot[:, None]) / self._acceleration
        worst: Array = np.maximum(velocity.max(axis=1) ** 2, acceleration.max(axis=1))
        return worst

    def largest_use(self, law: TimeLaw, t: Array) -> float:
        """By which factor time must be stretched to hold all limits at times `t`."""
        return float(np.sqrt(self.worst_ratio(law, t).max()))


def sample_law(path: JointPath, law: TimeLaw, window: float, stretch: float = 1.0) -> Trajectory:
    """The trajectory of a path under a time law that is slowed down evenly by `stretch`."""
    t = Trajectory.message_times(trajectory_times(law.duration, window) * stretch)
    s, s_dot, s_ddot = law.s_of(t / stretch)
    s[0], s[-1] = 0.0, 1.0
    s_dot[[0, -1]] = s_ddot[[0, -1]] = 0.0
    s_dot /= stretch
    s_ddot /= stretch**2
    q, q_s, q_ss = path.evaluate(s)
    return Trajectory(t, q, q_s * s_dot[:, None], q_ss * (s_dot**2)[:, None] + q_s * s_ddot[:, None])


def speed_grid(knots: Array) -> Array:
    """Path grid that holds all knots, subdivided evenly so that it has at least about `GRID` intervals."""
    parts = np.maximum(np.ceil(np.diff(knots) * GRID).astype(int), 4)
    pieces = [
        np.linspace(begin, end, count, endpoint=False)
        for begin, end, count in zip(knots[:-1], knots[1:], parts.tolist(), strict=True)
    ]
    return np.concatenate([*pieces, [1.0]])


def trajectory_times(duration: float, window: float) -> Array:
    """Even times from 0 to `duration`, `POINTS_PER_WINDOW` in a smoothing window."""
    count = int(np.ceil(duration / window * POINTS_PER_WINDOW)) + 1
    return np.linspace(0.0, duration, count)
