"""LinearJoint: point-to-point on a straight line in joint space."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from ruckig import InputParameter, Result, Ruckig
from ruckig import Trajectory as RuckigTrajectory

from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import TrajectoryGenerator, rest_trajectory

SHORTEST_MOVE = 1e-9  # rad (m) of the axis that moves most; less is rounding of a target
GRID_STEP = 0.05  # s, between the points besides the switches of jerk
# Points closer than this are one: the quintic between them would divide rounding by its fifth power.
CLOSEST_POINTS = 5e-5  # s


class LinearJoint(TrajectoryGenerator):
    """All axes start and stop together on a straight joint-space line, as fast as the slowest axis can.

    The line is q = q_start + s (q_target - q_start). Velocity, acceleration and jerk limits of every axis
    bound those of s; the time-optimal jerk-limited s(t) is Ruckig's (Berscheid and Kroeger 2021). A pose as
    target is reached in the configuration found from the start.
    """

    def _plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        return self._plan_to_joints(start, self.reach(target, start))

    def _plan_to_joints(self, start: Array, target: Array) -> Trajectory:
        delta = target - start
        length = float(np.abs(delta).max())
        if length < SHORTEST_MOVE:
            return rest_trajectory(start, target)
        # Path coordinate in units of the longest axis' travel, so that short moves keep their digits.
        direction = delta / length
        moved = np.abs(direction) > 0.0
        share = np.abs(direction[moved])
        time, s, s_dot, s_ddot = time_optimal(
            length,
            float((self.velocity[moved] / share).min()),
            float((self.acceleration[moved] / share).min()),
            float((self.jerk[moved] / share).min()),
        )
        position = start + s[:, None] * direction
        position[-1] = target
        return Trajectory(time, position, s_dot[:, None] * direction, s_ddot[:, None] * direction)


def time_optimal(
    length: float, velocity: float, acceleration: float, jerk: float
) -> tuple[Array, Array, Array, Array]:
    """Time-optimal jerk-limited motion from rest at 0 to rest at `length`.

    Returns:
        Times (m,), s, with every instant at which jerk switches; position, velocity and acceleration (m,).

    Raises:
        PlanningError: no profile was found.
    """
    command = InputParameter(1)
    command.target_position = [length]
    command.max_velocity, command.max_acceleration, command.max_jerk = [velocity], [acceleration], [jerk]
    plan = RuckigTrajectory(1)
    result = Ruckig(1).calculate(command, plan)
    if result not in (Result.Working, Result.Finished):
        raise PlanningError(
            f'no time-optimal profile over {length:.3g} with velocity {velocity:.3g}, acceleration '
            f'{acceleration:.3g} and jerk {jerk:.3g}: {result}',
            length=length,
        )
    profile = plan.profiles[0][0]
    switches = np.concatenate([[0.0], np.cumsum(profile.t)])
    time = Trajectory.message_times(profile_grid(switches))
    # Between switches jerk is constant; state at a switch plus its cubic.
    phase = np.clip(np.searchsorted(switches, time, side='right') - 1, 0, 6)
    t = time - switches[phase]
    p, v, a, j = (np.asarray(values)[phase] for values in (profile.p, profile.v, profile.a, profile.j))
    s = p + t * (v + t * (a / 2.0 + t * j / 6.0))
    s_dot = v + t * (a + t * j / 2.0)
    s_ddot = a + t * j
    s[0], s[-1] = 0.0, length
    s_dot[[0, -1]] = s_ddot[[0, -1]] = 0.0
    return time, s, s_dot, s_ddot


def profile_grid(switches: Array) -> Array:
    """Switch instants and a coarse uniform grid, without points that nearly coincide."""
    duration = float(switches[-1])
    chosen = [0.0]
    for switch in switches[1:-1]:
        if switch - chosen[-1] > CLOSEST_POINTS and duration - switch > CLOSEST_POINTS:
            chosen.append(float(switch))
    chosen.append(duration)
    grid: list[float] = [0.0]
    for begin, end in pairwise(chosen):
        parts = max(int(np.ceil((end - begin) / GRID_STEP)), 1)
        grid.extend(begin + (end - begin) * part / parts for part in range(1, parts))
        grid.append(end)
    return np.array(grid)
