"""TimeOptimalTiming: the fastest trajectory along a joint path inside all limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from robots_core.errors import PlanningError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.paths.path_grid import finer_grid, with_places
from robots_planning.paths.reparametrised_path import ReparametrisedPath
from robots_planning.timing.quintic import quintic_uses, quintics_at
from robots_planning.timing.speed_profile import fastest_speeds
from robots_planning.timing.switched_time_law import SwitchedTimeLaw
from robots_planning.timing.timed_path import PathStart, Smoothing, TimedPath, slower, with_times
from robots_planning.timing.tool_limits import LimitedRates, PathLimits
from robots_planning.timing.torque_limits import TorqueLimits
from robots_planning.trajectory import Trajectory

# Length of the ramps of acceleration, of the duration; all of them together lengthen the motion by one ramp.
RAMP = 3e-4
SHORTEST_RAMP = 5e-5  # s; shorter ones would magnify the rounding of positions
LONGEST_STEP = 0.006  # s between points of the trajectory
CHECKS_PER_STEP = 5
SPARSE = 2  # torques and the tool are checked in one of so many checks
# Torques are checked where the profile uses more than this fraction of their limits.
TORQUE_CHECKED = 0.7
RESERVE = 3e-4  # of the limits, at first, so that most trajectories need no second round
# Ramps tried with jerk limits, relative to what the motion needs that is not slowed down for its jerk: a
# shorter one costs less time everywhere, and more there.
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
class _Round:
    """A trajectory, and how it uses the limits.

    Attributes:
        trajectory: The trajectory.
        places: The path's own coordinate at its points, (m,).
        law: Its time law.
        use: Largest use of a limit but that of the jerk.
        jerk: That of the jerk.
    """

    trajectory: Trajectory
    places: Array
    law: SwitchedTimeLaw
    use: float
    jerk: float

    def timed(self, trajectory: Trajectory) -> TimedPath:
        """The trajectory, or a slower one, as the result."""
        smoothing = Smoothing(self.law.window, max(1.0, trajectory.duration / self.law.duration))
        return TimedPath(trajectory, self.places, smoothing)


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
        longest_ramp: Longest one without jerk limits, s.
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
        longest_ramp: float = np.inf,
    ) -> None:
        self._velocity, self._acceleration, self._jerk = velocity, acceleration, jerk
        self._axis_limits = np.array(
            [velocity, acceleration, np.full(len(velocity), np.inf) if jerk is None else jerk]
        )
        self._torques = None if effort is None else TorqueLimits(robot, effort)
        self._ramp, self._longest_ramp = ramp, longest_ramp

    def timed(self, path: JointPath, tool: PathLimits | None = None) -> TimedPath:
        """The fastest trajectory from rest to rest along a path.

        With jerk limits, the fastest of several, each smoothed by another window.

        Args:
            path: The joint path.
            tool: Limits of the tool besides those of the axes.

        Raises:
            PlanningError: the robot cannot hold itself against gravity somewhere on the path; names axis,
                torque, limit and the part of the path.
        """
        fastest, longest = None, np.inf
        for window in self._windows(path, tool):
            for plan in self._plans(path, tool, window, longest):
                if plan.trajectory.duration <= longest:
                    fastest, longest = plan, plan.trajectory.duration
        assert fastest is not None
        return fastest

    def _windows(self, path: JointPath, tool: PathLimits | None) -> list[float]:
        """Shortest ramps to try, s."""
        if self._jerk is None:
            return [SHORTEST_RAMP]
        # For a jump from one acceleration limit to the opposite one. Jerk falls with the length of a ramp.
        longest = float((2.0 * self._acceleration / self._jerk).max())
        needed = longest * min(1.0, next(self._rounds(path, tool, window=longest)).jerk)
        return [max(part * needed, SHORTEST_RAMP) for part in JERK_RAMPS]

    def _plans(
        self, path: JointPath, tool: PathLimits | None, window: float, longest: float
    ) -> Iterator[TimedPath]:
        """Trajectories inside the limits; none once they are sure to take more than `longest`, s."""
        last: _Round | None = None
        for last in self._rounds(path, tool, window=window, longest=longest):
            excess = max(last.use, last.jerk)
            if excess <= 1.0 + EXCESS:
                yield last.timed(slower(last.trajectory, excess))
                return
            if self._jerk is not None:
                yield last.timed(self._slowed(last))
        if last is not None and self._jerk is None:
            yield last.timed(self._slowed(last))

    def continued_from(self, path: JointPath, tool: PathLimits | None, start: PathStart) -> TimedPath:
        """The fastest trajectory to rest along a path of a robot that moves already.

        It is smoothed as the time law before it. It cannot be slowed down as a whole: limits are lowered
        where it would break them.

        Args:
            path: As for `timed`.
            tool: As for `timed`.
            start: How the motion begins.

        Raises:
            PlanningError: as `timed`, or the start is too fast for what is ahead.
        """
        for plan in self._rounds(path, tool, start=start):
            if max(plan.use, plan.jerk) <= 1.0 + MARGIN_EXCESS:
                return plan.timed(plan.trajectory)
        raise PlanningError('the path begins with a speed from which the limits ahead cannot be kept')

    def _rounds(
        self,
        path: JointPath,
        tool: PathLimits | None,
        *,
        start: PathStart | None = None,
        window: float = SHORTEST_RAMP,
        longest: float = np.inf,
    ) -> Iterator[_Round]:
        """Trajectories, each with the limits lowered where the one before broke them.

        Ramps of acceleration last at least `window`, s. There are no more once the time law takes more than
        `longest`, s: lowering limits makes it slower.
        """
        even = ReparametrisedPath(path, self._velocity, self._acceleration)
        s, stretch = even.grid, 1.0
        if start is not None:
            start = start.over(even)
            stretch, window = start.smoothing.stretch, start.smoothing.window
            first = start.before_average()[0]
            s = np.append(first, s[s > first + CLOSEST_START])
        rates = None
        if tool is not None:
            rates = PathLimits(partial(_rates_over, even, tool), even.sigma_of(tool.jumps))
            s = with_places(s, rates.jumps)
        limits = self._limits(s, even, rates)
        scale = np.full(len(s), 1.0 - RESERVE)
        for number in range(ROUNDS if start is None and self._jerk is None else MOST_ROUNDS):
            law = self._law(s, limits, scale, even, start)
            if start is None:
                law.window = max(min(self._ramp * law.duration, self._longest_ramp), window)
            else:
                law.window = window
            if law.duration * (1.0 - DISCRETISATION) > longest:
                return
            trajectory, places = self._sampled(even, law, limits[0], start)
            trajectory = slower(trajectory, stretch)
            times, use, jerk = self._use(trajectory, law, rates, limits[0], stretch)
            worst = float(use.max())
            yield _Round(trajectory, places, law, worst, float(jerk.max()))
            times = times / stretch
            if number == 0 and worst > COARSE:
                s = finer_grid(s, law.s_of(times[use > TOO_LONG])[0])
                limits = self._limits(s, even, rates)
                scale = np.full(len(s), 1.0 - RESERVE)
                continue
            # Jerk is a jump of acceleration over its ramp: it falls with the acceleration limits.
            use = np.maximum(use, jerk)
            if start is not None:
                # More from round to round: what is left gets smaller slowly.
                use = np.where(use > 1.0 + MARGIN_EXCESS, use + MARGIN_EXCESS * 1.5**number, use)
            scale = scale / local_excess(law, times, use)
            if start is None and float(scale.min()) < LOWEST_SCALE:
                return

    def _slowed(self, plan: _Round) -> Trajectory:
        """The motion slowed down uniformly until it keeps the limits."""
        trajectory, use, jerk = plan.trajectory, plan.use, plan.jerk
        for _ in range(2 * ROUNDS):
            if use <= 1.0 + MARGIN_EXCESS and jerk <= 1.0:
                break
            # Jerk falls with the third power of time.
            by = use if use > 1.0 + MARGIN_EXCESS else np.cbrt(jerk) * (1.0 + EXCESS)
            trajectory = slower(trajectory, by)
            _, uses, jerks = self._use(trajectory, plan.law, None)
            use, jerk = float(uses.max()), float(jerks.max())
        return trajectory

    def _limits(self, s: Array, path: ReparametrisedPath, rates: PathLimits | None) -> tuple[Array, Array]:
        """Rows (m, k, 4) of axes, tool and torques, and the highest s_dot^2 of the velocity limits, (m,)."""
        q, q_s, q_ss = path.evaluate(s)
        axes = np.zeros((*q.shape, 4))
        axes[:, :, 0], axes[:, :, 1] = q_s / self._acceleration, q_ss / self._acceleration
        rows, fraction = [axes], np.abs(q_s / self._velocity).max(axis=1)
        if rates is not None:
            found = rates.at(s)
            rows.append(found.rows())
            fraction = np.maximum(fraction, np.abs(found.rate / found.velocity).max(axis=1))
        if self._torques is not None:
            rows.append(self._torques.rows(q, q_s, q_ss))
        with np.errstate(divide='ignore'):
            return np.concatenate(rows, axis=1), 1.0 / fraction**2

    def _law(
        self,
        s: Array,
        limits: tuple[Array, Array],
        scale: Array,
        path: ReparametrisedPath,
        start: PathStart | None,
    ) -> SwitchedTimeLaw:
        """The time law of the fastest profile, without ramps."""
        u, difference = np.empty(len(s)), np.empty(len(s) - 1)
        u[0] = 0.0 if start is None else start.before_average()[1] ** 2
        failed = fastest_speeds(s, limits[0], limits[1] * scale, scale, PASSES, u, difference)
        if failed >= 0:
            assert self._torques is not None
            place = s[failed : failed + 1]
            raise self._torques.too_heavy(float(path.s_of(place)[0][0]), path.evaluate(place)[0][0])
        stuck = int(np.argmin(u[1:-1])) + 1
        if not u[stuck] > 0.0:
            fraction = float(path.s_of(s[stuck : stuck + 1])[0][0])
            raise PlanningError(
                f'the limits leave no speed at {100.0 * fraction:.1f} % of the path', fraction=fraction
            )
        return SwitchedTimeLaw(s, u, difference, 0.0, before=0.0 if start is None else start.s_ddot)

    def _sampled(
        self, path: ReparametrisedPath, law: SwitchedTimeLaw, rows: Array, start: PathStart | None
    ) -> tuple[Trajectory, Array]:
        """The trajectory, and the path's own coordinate at its points."""
        times = law.sample_times(LONGEST_STEP, np.abs(rows[:, :, 0]).max(axis=1))
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
        rates: PathLimits | None,
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
        coefficients = trajectory.coefficients
        uses = np.empty((len(points) - 1, 3))
        quintic_uses(points, coefficients, self._axis_limits, uses)
        use, jerk = (np.repeat(values, CHECKS_PER_STEP) for values in (uses[:, :2].max(axis=1), uses[:, 2]))
        if rates is not None:
            s, s_dot, s_ddot = law.s_of(times[::SPARSE] / stretch)
            used = rates.at(s).use(s_dot / stretch, s_ddot / stretch**2)
            use[::SPARSE] = np.maximum(use[::SPARSE], used)
            if rates.jumps.size:
                # The average over the window takes in what was allowed before the limits became lower.
                jump_times = law.times_of(rates.jumps)
                _, s_dot, s_ddot = law.s_of(jump_times)
                used = rates.at(rates.jumps).use(s_dot / stretch, s_ddot / stretch**2)
                np.maximum.at(use, np.searchsorted(times, stretch * jump_times, side='right') - 1, used)
        if self._torques is not None:
            # Torques follow the accelerations, which are checked everywhere.
            some = np.arange(0, len(times), SPARSE)
            if rows is not None and self._jerk is None:
                some = some[self._heavy(law, rows[:, -trajectory.num_axes :], times[some])]
            q, q_dot, q_ddot = (np.empty((len(some), trajectory.num_axes)) for _ in range(3))
            quintics_at(points, coefficients, times[some], q, q_dot, q_ddot)
            use[some] = np.maximum(use[some], self._torques.use(q, q_dot, q_ddot))
        return times, use, jerk

    @staticmethod
    def _heavy(law: SwitchedTimeLaw, rows: Array, times: Array) -> Array:
        """Whether the profile's torques are large close to times (k,), from the torque rows, (m, n, 4)."""
        speed, begin, end = law.at_grid
        parts = [
            np.abs(part[:, :, 0] * x[:, None] + part[:, :, 1] * (v**2)[:, None] + part[:, :, 2]).max(axis=1)
            for part, v, x in ((rows[:-1], speed[:-1], begin), (rows[1:], speed[1:], end))
        ]
        heavy = np.concatenate([[False], np.maximum(*parts) > TORQUE_CHECKED, [False]])
        heavy[1:-1] |= heavy[:-2] | heavy[2:]
        index = np.searchsorted(law.grid_times, times)
        chosen: Array = heavy[np.clip(index, 1, len(heavy) - 2)]
        return chosen


def _rates_over(even: ReparametrisedPath, limits: PathLimits, sigma: Array) -> LimitedRates:
    """The limits at values of the coordinate sigma, (m,), from those over s."""
    s, first, second = even.s_of(sigma)
    return limits.at(s).over(first, second)


def local_excess(law: SwitchedTimeLaw, times: Array, use: Array) -> Array:
    """Factors by which limits are lowered at the grid points: the excess near by, increased by a fifth."""
    grid_times, excess = law.grid_times, np.maximum(use, 1.0)
    if law.window > LONGEST_STEP:
        # The acceleration depends on everything inside the window.
        even = np.arange(0.0, law.duration, LONGEST_STEP)
        worst = np.ones(len(even))
        np.maximum.at(worst, np.minimum((times / LONGEST_STEP).astype(int), len(even) - 1), excess)
        excess, times = worst.copy(), even
        for shift in range(1, int(0.5 * law.window / LONGEST_STEP) + 2):
            excess[shift:] = np.maximum(excess[shift:], worst[:-shift])
            excess[:-shift] = np.maximum(excess[:-shift], worst[shift:])
    # A grid point covers the checks up to its neighbours, and the check before it where the grid is finer.
    index = np.clip(np.searchsorted(grid_times, times), 1, len(grid_times) - 1)
    lowered = excess[np.clip(np.searchsorted(times, grid_times) - 1, 0, len(times) - 1)]
    np.maximum.at(lowered, index, excess)
    np.maximum.at(lowered, index - 1, excess)
    spread = np.maximum(lowered, np.maximum(np.append(lowered[1:], 1.0), np.append(1.0, lowered[:-1])))
    return np.asarray(1.0 + 1.2 * (spread - 1.0))
