"""TimeOptimalTiming: the fastest trajectory along a joint path inside all limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from weakref import WeakKeyDictionary

import numpy as np
from scipy.ndimage import maximum_filter1d

from robots_core.errors import InvalidInputError, PlanningError
from robots_core.kernels.chain_dynamics import ChainDynamics, bodies_of
from robots_core.kernels.serial_chain import SerialChain
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.paths.path_grid import finer_grid
from robots_planning.paths.reparametrised_path import ReparametrisedPath
from robots_planning.timing.path_dynamics import memory_for, torque_rows, torque_use
from robots_planning.timing.path_start import PathStart
from robots_planning.timing.quintic import quintic_uses, quintics_at
from robots_planning.timing.speed_profile import fastest_speeds
from robots_planning.timing.switched_time_law import SwitchedTimeLaw
from robots_planning.timing.timed_path import TimedPath, TooSlowError, slower, with_times
from robots_planning.trajectory import Trajectory

# Length of the ramps of acceleration, of the duration; all of them together lengthen the motion by one ramp.
RAMP = 3e-4
SHORTEST_RAMP = 5e-5  # s; shorter ones would magnify the rounding of positions
LONGEST_STEP = 0.006  # s between points of the trajectory
CHECKS_PER_STEP = 5
TORQUE_CHECK = 2  # one in so many checks
# Torques are checked where the profile uses more than this fraction of their limits.
TORQUE_LOOK = 0.7
RESERVE = 3e-4  # of the limits, at first, so that most trajectories need no second round
# Ramps tried with jerk limits, relative to what the largest jump of acceleration needs: a shorter one costs
# less time everywhere, and more where the motion is slowed down for its jerk.
JERK_RAMPS = (1.0, 0.75, 0.55)
PASSES = 3  # the first with constant s_ddot from point to point, the others with the slopes of the one before
ROUNDS = 6  # of lowering limits that the trajectory broke
MOST_ROUNDS = 16  # where what is left cannot be slowed down as a whole
DISCRETISATION = 1e-3  # of a duration, by which a profile may be slower than the fastest
LOWEST_SCALE = 0.1  # of the limits; below it lowering them is given up
# Use of a limit: above the first the grid is too coarse for the path, and is refined wherever the use is
# above the second.
COARSE, TOO_LONG = 1.04, 1.005
CLOSEST_START = 1e-6  # of the path, from a start that moves to the next point of the grid
EXCESS = 3e-4  # of a limit, not worth another round; `LIMIT_MARGIN` covers a third of it
MARGIN_EXCESS = 1e-4  # that `LIMIT_MARGIN` covers


@dataclass(frozen=True, eq=False)
class ToolLimits:
    """Limits of k quantities along a path, such as the tool's tangential and normal motion.

    Attributes:
        derivatives: From s (m,) to their first and second derivatives over s, (m, k) each: of the travelled
            length (m) and angle (rad), for example.
        velocity: (k,), m/s and rad/s.
        acceleration: (k,), m/s^2 and rad/s^2.
    """

    derivatives: Callable[[Array], tuple[Array, Array]]
    velocity: Array
    acceleration: Array


class TimeOptimalTiming:
    """From joint paths to the fastest trajectories, by dynamic programming over path and speed.

    Velocity, acceleration and torque limits hold on a grid that is finer where the path is curved, and
    between grid points by the interpolation of `fastest_speeds`. The resulting trajectory is checked; where
    it exceeds a limit, limits are lowered locally and the profile is computed again. Torques are those of the
    robot's rigid dynamics, gravity included.

    Args:
        robot: The robot.
        velocity: Highest speed per axis, (n,), rad/s (m/s).
        acceleration: Highest acceleration per axis, (n,), rad/s^2 (m/s^2).
        effort: Highest torque per axis, (n,), N m (N); None for no torque limits.
        jerk: Highest jerk per axis, (n,), rad/s^3 (m/s^3); None for no jerk limits. With them the motion is
            no longer the fastest: the time law is smoothed until it keeps them.
        ramp: Part of the duration in which acceleration may jump from one value to another.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        velocity: Array,
        acceleration: Array,
        effort: Array | None = None,
        *,
        jerk: Array | None = None,
        ramp: float = RAMP,
    ) -> None:
        self._robot = robot
        self._jerk = jerk
        self._velocity, self._acceleration = velocity, acceleration
        # A copy: read-only arrays would be compiled for once more.
        self._effort = None if effort is None else np.array(effort)
        self._axis_limits = np.array(
            [velocity, acceleration, np.full(len(velocity), np.inf) if jerk is None else jerk]
        )
        self._ramp = ramp
        self._dynamics = None if effort is None else _dynamics_of(robot)

    def timed(self, path: JointPath, tool: ToolLimits | None = None, longest: float = np.inf) -> TimedPath:
        """The fastest trajectory from rest to rest along a path.

        With jerk limits, the fastest of several, each smoothed by another window.

        Args:
            path: The joint path.
            tool: Limits of the tool besides those of the axes.
            longest: Longest duration that the caller accepts, s; planning stops once it is exceeded.

        Raises:
            PlanningError: the robot cannot hold itself against gravity somewhere on the path; names axis,
                torque, limit and the part of the path.
            TooSlowError: the fastest trajectory takes longer.
        """
        ramps = [SHORTEST_RAMP]
        if self._jerk is not None:
            # Ramp for a jump from one acceleration limit to the opposite one.
            jump = float((2.0 * self._acceleration / self._jerk).max())
            ramps = [part * jump for part in JERK_RAMPS]
        plans = [plan for ramp in ramps for plan in self._plans(path, tool, ramp, longest)]
        fastest = min(plans, key=lambda plan: plan.trajectory.duration, default=None)
        if fastest is None or fastest.trajectory.duration > longest:
            raise TooSlowError
        return fastest

    def trajectory(
        self, path: JointPath, tool: ToolLimits | None = None, longest: float = np.inf
    ) -> Trajectory:
        """The trajectory of `timed` alone; arguments and errors as there."""
        return self.timed(path, tool, longest).trajectory

    def _plans(
        self, path: JointPath, tool: ToolLimits | None, shortest: float, longest: float
    ) -> list[TimedPath]:
        """Trajectories inside the limits whose ramps of acceleration last `shortest` (s) or more.

        Planning stops once they are sure to take more than `longest`, s: lowering limits only makes them
        slower.
        """
        even, tool = self._even(path, tool)
        s = even.grid
        limits, scale = self._limits(s, even, tool)
        plans: list[TimedPath] = []
        for number in range(ROUNDS):
            law = self._law(s, limits, scale, even, shortest)
            if law.duration * (1.0 - DISCRETISATION) > longest:
                return plans
            trajectory, places = self._sampled(even, law, limits)
            times, use, jerk = self._use(trajectory, law, tool, limits[0])
            worst = float(use.max())
            if number == 0 and worst > COARSE:
                s = finer_grid(s, law.s_of(times[use > TOO_LONG])[0])
                limits, scale = self._limits(s, even, tool)
                continue
            if self._jerk is not None:
                plans.append(TimedPath.of(self._slowed(trajectory, law, worst), places, law))
                # Jerk is a jump of acceleration over its ramp: it falls with the acceleration limits.
                use = np.maximum(use, jerk)
            excess = float(use.max())
            if excess <= 1.0 + EXCESS:
                return [*plans, TimedPath.of(slower(trajectory, excess), places, law)]
            scale = scale / local_excess(law, times, use)
            if float(scale.min()) < LOWEST_SCALE:
                break
        return [*plans, TimedPath.of(self._slowed(trajectory, law, worst), places, law)]

    def carried_on(self, path: JointPath, tool: ToolLimits | None, start: PathStart) -> TimedPath:
        """The fastest trajectory to rest along a path of a robot that moves already.

        It is smoothed as the time law before it. It cannot be slowed down as a whole: limits are lowered
        where it would break them.

        Args:
            path: The joint path.
            tool: Limits of the tool besides those of the axes.
            start: How the motion begins.

        Raises:
            PlanningError: as `timed`, or the start is too fast for what is ahead.
        """
        (even, tool), smoothing = self._even(path, tool), start.smoothing
        start, s = start.over(even), even.grid
        first = start.before_average()[0]
        s = np.append(first, s[s > first + CLOSEST_START])
        limits, scale = self._limits(s, even, tool)
        for number in range(MOST_ROUNDS):
            law = self._law(s, limits, scale, even, smoothing.window, start=start)
            trajectory, places = self._sampled(even, law, limits, start)
            trajectory = slower(trajectory, smoothing.stretch)
            times, use, jerk = self._use(trajectory, law, tool, limits[0], smoothing.stretch)
            if self._jerk is not None:
                use = np.maximum(use, jerk)
            if float(use.max()) <= 1.0 + MARGIN_EXCESS:
                return TimedPath.of(trajectory, places, law)
            if number == 0 and float(use.max()) > COARSE:
                s = finer_grid(s, law.s_of(times[use > TOO_LONG] / smoothing.stretch)[0])
                limits, scale = self._limits(s, even, tool)
                continue
            # More from round to round: what is left gets smaller slowly.
            use = np.where(use > 1.0 + MARGIN_EXCESS, use + MARGIN_EXCESS * 1.5**number, use)
            scale = scale / local_excess(law, times / smoothing.stretch, use)
        raise PlanningError('the path begins with a speed from which the limits ahead cannot be kept')

    def _slowed(self, trajectory: Trajectory, law: SwitchedTimeLaw, worst: float) -> Trajectory:
        """The motion slowed down uniformly until it keeps the limits; `worst` is the largest use of one."""
        for _ in range(ROUNDS):
            if worst <= 1.0 + MARGIN_EXCESS:
                break
            trajectory = slower(trajectory, worst)
            worst = float(self._use(trajectory, law, None)[1].max())
        if self._jerk is None:
            return trajectory
        for _ in range(ROUNDS):
            jerk = float(self._use(trajectory, law, None)[2].max())
            if jerk <= 1.0:
                break
            trajectory = slower(trajectory, jerk ** (1.0 / 3.0) * (1.0 + EXCESS))
        return trajectory

    def _even(self, path: JointPath, tool: ToolLimits | None) -> tuple[ReparametrisedPath, ToolLimits | None]:
        """The path and the tool's limits over a coordinate along which the axes move evenly."""
        even = ReparametrisedPath(path, self._velocity, self._acceleration)
        if tool is not None:
            tool = replace(tool, derivatives=partial(even.derivatives, tool.derivatives))
        return even, tool

    def _limits(
        self, s: Array, path: ReparametrisedPath, tool: ToolLimits | None
    ) -> tuple[tuple[Array, Array], Array]:
        """Rows (m, k, 4), the highest s_dot^2 of the velocity limits, and the part to use."""
        q, q_s, q_ss = path.evaluate(s)
        m, n = q.shape
        rows = np.zeros(
            (m, n * (2 if self._effort is not None else 1) + (len(tool.acceleration) if tool else 0), 4)
        )
        rows[:, :n, 0], rows[:, :n, 1] = q_s / self._acceleration, q_ss / self._acceleration
        fraction = np.abs(q_s / self._velocity).max(axis=1)
        if tool is not None:
            first, second = tool.derivatives(s)
            part = slice(n, n + len(tool.acceleration))
            rows[:, part, 0], rows[:, part, 1] = first / tool.acceleration, second / tool.acceleration
            fraction = np.maximum(fraction, (first / tool.velocity).max(axis=1))
        if self._effort is not None:
            self._torque_rows(q, q_s, q_ss, rows[:, -n:, :3])
        with np.errstate(divide='ignore'):
            return (rows, 1.0 / fraction**2), np.full(m, 1.0 - RESERVE)

    def _torque_rows(self, q: Array, q_s: Array, q_ss: Array, rows: Array) -> None:
        effort = self._effort
        assert effort is not None
        if self._dynamics is not None:
            filled = np.empty(rows.shape)
            torque_rows(self._dynamics.arrays, q, q_s, q_ss, effort, filled, memory_for(len(effort)))
            rows[:] = filled
            return
        still = np.zeros(q.shape[1])
        for row, *state in zip(rows, q, q_s, q_ss, strict=True):
            position, first, second = state
            rest = self._robot.rigid_dynamics(position, still, still)[2]
            tau, M, _ = self._robot.rigid_dynamics(position, first, second)
            row[:] = np.column_stack([M @ first, tau - rest, rest]) / effort[:, None]

    def _law(
        self,
        s: Array,
        limits: tuple[Array, Array],
        scale: Array,
        path: ReparametrisedPath,
        shortest: float,
        *,
        start: PathStart | None = None,
    ) -> SwitchedTimeLaw:
        u, difference = np.empty(len(s)), np.empty(len(s) - 1)
        u[0] = 0.0 if start is None else start.before_average()[1] ** 2
        failed = fastest_speeds(s, limits[0], limits[1] * scale**2, scale, PASSES, u, difference)
        if failed >= 0:
            place = s[failed : failed + 1]
            raise self._too_heavy(float(path.s_of(place)[0][0]), path.evaluate(place)[0][0])
        stuck = int(np.argmin(u[1:-1])) + 1
        if not u[stuck] > 0.0:
            fraction = float(path.s_of(s[stuck : stuck + 1])[0][0])
            raise PlanningError(
                f'the limits leave no speed at {100.0 * fraction:.1f} % of the path', fraction=fraction
            )
        if start is None:
            return SwitchedTimeLaw(s, u, difference, self._ramp, shortest)
        return SwitchedTimeLaw(s, u, difference, 0.0, shortest, before=start.s_ddot)

    def _sampled(
        self,
        path: ReparametrisedPath,
        law: SwitchedTimeLaw,
        limits: tuple[Array, Array],
        start: PathStart | None = None,
    ) -> tuple[Trajectory, Array]:
        """The trajectory, and the path's own coordinate at its points."""
        times = law.sample_times(LONGEST_STEP, np.abs(limits[0][:, :, 0]).max(axis=1))
        if len(path.seams):
            times = with_times(times, law.times_of(path.seams))
        t = Trajectory.message_times(times)
        s, s_dot, s_ddot = law.s_of(t)
        s[0], s[-1] = 0.0, 1.0
        s_dot[[0, -1]] = s_ddot[[0, -1]] = 0.0
        if start is not None:
            s_dot[0], s_ddot[0] = start.s_dot, start.s_ddot
        q, q_s, q_ss = path.evaluate(s)
        q[[0, -1]] = path.ends  # without rounding: the next motion starts exactly there
        q_ddot = q_ss * (s_dot**2)[:, None] + q_s * s_ddot[:, None]
        return Trajectory(t, q, q_s * s_dot[:, None], q_ddot), path.s_of(s)[0]

    def _use(
        self,
        trajectory: Trajectory,
        law: SwitchedTimeLaw,
        tool: ToolLimits | None,
        rows: Array | None = None,
        stretch: float = 1.0,
    ) -> tuple[Array, Array, Array]:
        """Times between the points, the largest use of a limit there, and that of the jerk limits.

        The trajectory takes longer than the law by the factor `stretch`.
        With the `rows` of the limits torques are checked only where they may be large, else everywhere.
        """
        points = trajectory.time
        parts = np.arange(CHECKS_PER_STEP) / CHECKS_PER_STEP
        times = (points[:-1, None] + np.diff(points)[:, None] * parts).ravel()
        coefficients = np.array(trajectory.coefficients)  # read-only arrays would be compiled for once more
        uses = np.empty((len(points) - 1, 3))
        quintic_uses(points, coefficients, self._axis_limits, uses)
        use, jerk = (np.repeat(values, CHECKS_PER_STEP) for values in (uses[:, :2].max(axis=1), uses[:, 2]))
        if tool is not None:
            s, s_dot, s_ddot = law.s_of(times / stretch)
            s_dot, s_ddot = s_dot / stretch, s_ddot / stretch**2
            first, second = tool.derivatives(s)
            speed, acceleration = (
                first * s_dot[:, None],
                second * (s_dot**2)[:, None] + first * s_ddot[:, None],
            )
            use = np.maximum(use, (speed / tool.velocity).max(axis=1))
            use = np.maximum(use, np.abs(acceleration / tool.acceleration).max(axis=1))
        if self._effort is not None:
            # Torques follow the accelerations, which are checked everywhere.
            some = np.arange(0, len(times), TORQUE_CHECK)
            if rows is not None and self._jerk is None:
                some = some[self._heavy(law, rows[:, -trajectory.num_axes :], times[some])]
            q, q_dot, q_ddot = (np.empty((len(some), trajectory.num_axes)) for _ in range(3))
            quintics_at(points, coefficients, times[some], q, q_dot, q_ddot)
            use[some] = np.maximum(use[some], self._torque_use(q, q_dot, q_ddot))
        return times, use, jerk

    @staticmethod
    def _heavy(law: SwitchedTimeLaw, rows: Array, times: Array) -> Array:
        """Whether the profile's torques are large close to times (k,), from the torque rows, (m, n, 4)."""
        speed, begin, end = law.at_grid
        parts = [
            np.abs(part[:, :, 0] * x[:, None] + part[:, :, 1] * (v**2)[:, None] + part[:, :, 2]).max(axis=1)
            for part, v, x in ((rows[:-1], speed[:-1], begin), (rows[1:], speed[1:], end))
        ]
        heavy = np.concatenate([[False], np.maximum(*parts) > TORQUE_LOOK, [False]])
        heavy[1:-1] |= heavy[:-2] | heavy[2:]
        index = np.searchsorted(law.grid_times, times)
        chosen: Array = heavy[np.clip(index, 1, len(heavy) - 2)]
        return chosen

    def _torque_use(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        effort = self._effort
        assert effort is not None
        if self._dynamics is None:
            model = self._robot.rigid_dynamics_model
            tau = np.array([model.torques(*state) for state in zip(q, q_dot, q_ddot, strict=True)])
            slow: Array = np.abs(tau / effort).max(axis=1)
            return slow
        filled = np.empty(q.shape)
        torque_use(self._dynamics.arrays, q, q_dot, q_ddot, effort, filled, bodies_of(len(effort)))
        use: Array = filled.max(axis=1)
        return use

    def _too_heavy(self, s: float, q: Array) -> PlanningError:
        assert self._effort is not None
        still = np.zeros(len(q))
        tau = self._robot.rigid_dynamics(q, still, still)[2]
        axis = int(np.argmax(np.abs(tau / self._effort)))
        axes = self._robot.axes_data
        unit = axes.unit(axis, 'torque')
        return PlanningError(
            f'{axes.names[axis]} cannot hold the robot at {100.0 * s:.1f} % of the path: gravity asks for '
            f'{abs(tau[axis]):.6g} {unit}, its limit is {self._effort[axis]:.6g} {unit}; choose another '
            'path or configuration',
            fraction=s,
            joint=axes.names[axis],
            value=float(tau[axis]),
            bound=float(self._effort[axis]),
            unit=unit,
        )


_DYNAMICS: WeakKeyDictionary[BaseRobotModel, ChainDynamics | None] = WeakKeyDictionary()


def _dynamics_of(robot: BaseRobotModel) -> ChainDynamics | None:
    """The robot's dynamics for compiled code, cached; None if only its own methods compute them."""
    if robot not in _DYNAMICS:
        try:
            _DYNAMICS[robot] = ChainDynamics.of(robot, SerialChain.of(robot))
        except InvalidInputError:
            _DYNAMICS[robot] = None
    return _DYNAMICS[robot]


def local_excess(law: SwitchedTimeLaw, times: Array, use: Array) -> Array:
    """Factors by which limits are lowered at the grid points: the excess near by, increased by a fifth."""
    grid_times, excess = law.grid_times, np.maximum(use, 1.0)
    if law.window > LONGEST_STEP:
        # The acceleration depends on everything inside the window.
        even = np.arange(0.0, law.duration, LONGEST_STEP)
        worst = np.ones(len(even))
        np.maximum.at(worst, np.minimum((times / LONGEST_STEP).astype(int), len(even) - 1), excess)
        reach = 2 * int(0.5 * law.window / LONGEST_STEP) + 3
        excess, times = maximum_filter1d(worst, reach), even
    # A grid point covers the checks up to its neighbours, and the check before it where the grid is finer.
    index = np.clip(np.searchsorted(grid_times, times), 1, len(grid_times) - 1)
    lowered = excess[np.clip(np.searchsorted(times, grid_times) - 1, 0, len(times) - 1)]
    np.maximum.at(lowered, index, excess)
    np.maximum.at(lowered, index - 1, excess)
    spread = np.maximum(lowered, np.maximum(np.append(lowered[1:], 1.0), np.append(1.0, lowered[:-1])))
    return np.asarray(1.0 + 1.2 * (spread - 1.0))
