"""Verification: an independent check of any trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.path_deviation import identity_orientations, line_deviation, path_deviation
from robots_planning.trajectory import Trajectory
from robots_planning.verification.limit_use import AxisExtremes, LimitUse, ToolSection, tool_speeds

SAMPLE_PERIOD = 1e-3  # s
LONGEST_MOTION = 3600.0  # s
DYNAMICS_PERIOD = 4e-3  # s, the period of the controller; torques change little within it
RATIO_TOLERANCE = 1e-3  # of a limit: what finite differences at the sample period can resolve
POSITION_TOLERANCE = 1e-9  # rad (m), as the axis limits' own check
REST_TOLERANCE = 1e-6  # of the velocity and acceleration limits, at both ends
LINE_TOLERANCE = 1e-5  # m and rad
# Of position (rad, m), and of the velocity and acceleration limits, from one interval to the next: rounding
# of the polynomials' coefficients, which is multiplied by up to the inverse of an interval and its square.
JUMP_TOLERANCE = (1e-9, 1e-6, 1e-4)


@dataclass(frozen=True, eq=False)
class VerificationReport:
    """What `verify` found.

    Attributes:
        duration: Of the trajectory, s.
        uses: Worst use by quantity: position, velocity, acceleration, jerk, and torque if it was asked for.
        axis_use: By quantity, worst ratio of every axis, (n,).
        outside: How far positions pass the axis limits, rad (m); negative is the margin left.
        start_motion: Difference of velocity or acceleration at the start from those of the robot, as part of
            their limits; 0 is rest, or the motion that was given.
        end_motion: Velocity or acceleration at the end, as part of its limit; 0 is rest.
        jumps: Largest step from one interval to the next of position (rad, m), and of velocity and
            acceleration as parts of their limits; 0 except for rounding.
        jump_time: When the worst of them is, s.
        line_deviation: Largest distance of the tool from the line or path and of its ends from theirs, m;
            None without one.
        orientation_deviation: Largest angle between the tool and the line's or path's orientation, rad.
    """

    duration: float
    uses: dict[str, LimitUse]
    axis_use: dict[str, Array]
    outside: float
    start_motion: float
    end_motion: float
    jumps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    jump_time: float = 0.0
    line_deviation: float | None = None
    orientation_deviation: float | None = None

    @cached_property
    def violations(self) -> tuple[str, ...]:
        """One line per limit that is broken. Jerk is reported in `uses`, and breaks nothing."""
        lines = []
        for quantity, use in self.uses.items():
            broken = (
                self.outside > POSITION_TOLERANCE
                if quantity == 'position'
                else use.ratio > 1.0 + RATIO_TOLERANCE
            )
            if broken and quantity != 'jerk':
                lines.append(use.describe())
        lines.extend(
            f'the trajectory does not {what}: it differs by {100.0 * motion:.3g} % of a limit'
            for what, motion in (
                ('start at rest or as the robot moves', self.start_motion),
                ('end at rest', self.end_motion),
            )
            if motion > REST_TOLERANCE
        )
        lines.extend(
            f'{quantity} jumps by {jump:.3g}{unit} at {self.jump_time:.3f} s'
            for quantity, unit, jump, allowed in zip(
                ('position', 'velocity', 'acceleration'),
                (' rad (m)', ' of its limit', ' of its limit'),
                self.jumps,
                JUMP_TOLERANCE,
                strict=True,
            )
            if jump > allowed
        )
        if self.line_deviation is not None and self.line_deviation > LINE_TOLERANCE:
            lines.append(
                f'the tool leaves its line by {self.line_deviation * 1e3:.4g} mm, allowed is '
                f'{LINE_TOLERANCE * 1e3:g} mm'
            )
        if self.orientation_deviation is not None and self.orientation_deviation > LINE_TOLERANCE:
            lines.append(
                f'the tool turns {self.orientation_deviation:.4g} rad away from its line, allowed is '
                f'{LINE_TOLERANCE:g} rad'
            )
        return tuple(lines)

    @property
    def ok(self) -> bool:
        """No limit is broken."""
        return not self.violations

    @property
    def limiting(self) -> LimitUse:
        """The highest use of a velocity, acceleration or torque limit: what makes the motion last."""
        timed = (self.uses[name] for name in ('velocity', 'acceleration', 'torque') if name in self.uses)
        return max(timed, key=lambda use: use.ratio)

    def describe(self) -> str:
        """A line per broken limit, or one line that says that all are kept."""
        if self.ok:
            use = self.limiting
            return (
                f'all limits kept; the highest use is {100.0 * use.ratio:.1f} % of the {use.quantity} of '
                f'{use.joint} at {use.time:.3f} s'
            )
        return '\n'.join(self.violations)


def verify(
    trajectory: Trajectory,
    robot: BaseRobotModel,
    *,
    line: tuple[Pose, Pose] | None = None,
    path: CartesianPath | None = None,
    oriented: bool = True,
    tool: Pose | None = None,
    tools: Sequence[ToolSection] = (),
    torque: bool = True,
    start_motion: tuple[ArrayLike, ArrayLike] | None = None,
) -> VerificationReport:
    """Compare a trajectory with all limits of a robot, without knowing how it was planned.

    Positions are sampled at 1 kHz and differentiated by central differences; velocity and acceleration of
    the trajectory itself are taken at the same instants, positions and velocities at their turning points
    between them too, and acceleration and jerk at every extreme between the trajectory's points. Torques come
    from inverse dynamics at 250 Hz.

    Args:
        trajectory: The one to verify.
        robot: Whose limits hold.
        line: First and last pose of a straight tool line with rotation about one axis to stay on.
        path: Any other path of the tool to stay on.
        oriented: The tool keeps the orientations of line or path, and not its positions alone.
        tool: Pose of what follows line or path in tool0; tool0 itself by default.
        tools: Limits of the tool on the parts of the trajectory, in order.
        torque: Compute torques too.
        start_motion: Velocity and acceleration, (n,) each, of the motion that it continues from; it starts at
            rest without.

    Raises:
        InvalidInputError: the trajectory has another number of axes than the robot, or takes more than
            `LONGEST_MOTION`.
    """
    axes = robot.axes_data
    if trajectory.duration > LONGEST_MOTION:
        raise InvalidInputError(
            f'the motion takes {trajectory.duration:.6g} s; allowed are {LONGEST_MOTION:g} s'
        )
    if trajectory.num_axes != axes.num_axes:
        raise InvalidInputError(
            f'the trajectory has {trajectory.num_axes} axes, robot {robot.name} has {axes.num_axes}'
        )
    count = int(np.ceil(trajectory.duration / SAMPLE_PERIOD)) + 1
    t = np.union1d(np.linspace(0.0, trajectory.duration, max(count, 16)), trajectory.time)
    q, q_dot, q_ddot = trajectory.sample(t)
    before, after = trajectory.sample_position(t + SAMPLE_PERIOD * np.array([[-1.0], [1.0]]))
    if start_motion is not None:
        # What was before the start is unknown: as if it had moved at constant acceleration.
        early = (t < SAMPLE_PERIOD)[:, None]
        past = q - SAMPLE_PERIOD * q_dot + 0.5 * SAMPLE_PERIOD**2 * q_ddot
        before, after = np.where(early, past, before), np.where(early, 2.0 * q - past, after)
        after += np.where(early, SAMPLE_PERIOD**2 * q_ddot, 0.0)
    # A difference is an average of what it stands for, so it can only understate a limit that is broken.
    differences = np.abs(after - before) / (2.0 * SAMPLE_PERIOD)
    second_differences = np.abs(after - 2.0 * q + before) / SAMPLE_PERIOD**2
    extreme_times, accelerations, jerks = trajectory.acceleration_extremes()
    turning = _turning(trajectory, t, q_dot, 0)
    peak_times, peaks = _turning(trajectory, t, q_ddot, 1)
    found = {
        'position': AxisExtremes.of_positions(axes, (t, q), turning),
        'velocity': AxisExtremes.of(
            axes.velocity, (t, np.abs(q_dot)), (t, differences), (peak_times, np.abs(peaks))
        ),
        'acceleration': AxisExtremes.of(
            axes.acceleration, (t, np.abs(q_ddot)), (t, second_differences), (extreme_times, accelerations)
        ),
        'jerk': AxisExtremes.of(axes.jerk, (extreme_times, jerks)),
    }
    if torque:
        found['torque'] = _torques(trajectory, robot)
    uses = {quantity: extremes.worst(quantity, axes) for quantity, extremes in found.items()}
    position = found['position'].value
    deviation, turned = _deviation(trajectory, robot, line, path, tool, oriented=oriented)
    jumps, jump_time = _jumps(trajectory, robot)
    return VerificationReport(
        duration=trajectory.duration,
        uses=uses | tool_speeds(trajectory, robot, tools),
        axis_use={quantity: read_only(extremes.ratio) for quantity, extremes in found.items()},
        outside=float(np.maximum(axes.lower - position, position - axes.upper).max()),
        start_motion=_motion(trajectory, robot, 0, start_motion),
        end_motion=_motion(trajectory, robot, -1),
        jumps=jumps,
        jump_time=jump_time,
        line_deviation=deviation,
        orientation_deviation=turned,
    )


def _torques(trajectory: Trajectory, robot: BaseRobotModel) -> AxisExtremes:
    count = int(np.ceil(trajectory.duration / DYNAMICS_PERIOD)) + 1
    t = np.linspace(0.0, trajectory.duration, max(count, 5))
    model = robot.rigid_dynamics_model
    tau = np.abs([model.torques(*state) for state in zip(*trajectory.sample(t), strict=True)])
    return AxisExtremes.of(robot.axes_data.effort, (t, tau))


def _turning(trajectory: Trajectory, t: Array, rate: Array, derivative: int) -> tuple[Array, Array]:
    """Times, (k,), and values, (k, n), of a derivative where its rate changes sign between the times t."""
    # Of a contiguous array in a fraction of the time that nonzero() takes for rows and columns.
    rows, axes = np.divmod(np.flatnonzero(rate[:-1] * rate[1:] < 0.0), trajectory.num_axes)
    before, after = rate[rows, axes], rate[rows + 1, axes]
    times = t[rows] + (t[rows + 1] - t[rows]) * before / (before - after)
    return times, trajectory.sample(times)[derivative]


def _jumps(trajectory: Trajectory, robot: BaseRobotModel) -> tuple[tuple[float, float, float], float]:
    """Largest steps of position, velocity and acceleration at the points, and when the worst is."""
    c, h = trajectory.coefficients, np.diff(trajectory.time)[:, None]
    end_q = c[:, 0] + h * (c[:, 1] + h * (c[:, 2] + h * (c[:, 3] + h * (c[:, 4] + h * c[:, 5]))))
    end_q_dot = c[:, 1] + h * (2 * c[:, 2] + h * (3 * c[:, 3] + h * (4 * c[:, 4] + h * 5 * c[:, 5])))
    end_q_ddot = 2 * c[:, 2] + h * (6 * c[:, 3] + h * (12 * c[:, 4] + h * 20 * c[:, 5]))
    q, q_dot, q_ddot = trajectory.position, trajectory.velocity, trajectory.acceleration
    axes = robot.axes_data
    steps = np.array(
        [
            np.maximum(np.abs(end_q - q[1:]), np.abs(c[:, 0] - q[:-1])),
            np.maximum(np.abs(end_q_dot - q_dot[1:]), np.abs(c[:, 1] - q_dot[:-1])) / axes.velocity,
            np.maximum(np.abs(end_q_ddot - q_ddot[1:]), np.abs(2 * c[:, 2] - q_ddot[:-1]))
            / axes.acceleration,
        ]
    )
    _, worst, _ = np.unravel_index(int((steps / np.reshape(JUMP_TOLERANCE, (3, 1, 1))).argmax()), steps.shape)
    position, velocity, acceleration = steps.reshape(3, -1).max(axis=1).tolist()
    return (position, velocity, acceleration), float(trajectory.time[worst + 1])


def _motion(
    trajectory: Trajectory,
    robot: BaseRobotModel,
    row: int,
    expected: tuple[ArrayLike, ArrayLike] | None = None,
) -> float:
    axes = robot.axes_data
    q_dot, q_ddot = (np.asarray(values) for values in expected or (0.0, 0.0))
    return float(
        max(
            (np.abs(trajectory.velocity[row] - q_dot) / axes.velocity).max(),
            (np.abs(trajectory.acceleration[row] - q_ddot) / axes.acceleration).max(),
        )
    )


def _deviation(
    trajectory: Trajectory,
    robot: BaseRobotModel,
    line: tuple[Pose, Pose] | None,
    path: CartesianPath | None,
    tool: Pose | None,
    *,
    oriented: bool,
) -> tuple[float | None, float | None]:
    """Largest distance (m) and angle (rad; None if not `oriented`) from the line or path, ends included."""
    if line is None and path is None:
        return None, None
    # Interpolation errors are largest in the middle between points.
    middles = 0.5 * (trajectory.time[:-1] + trajectory.time[1:])
    t = np.union1d(np.linspace(0.0, trajectory.duration, 101), middles)
    r, T = robot.tool_poses(trajectory.sample_position(t))
    if tool is not None:
        r, T = r + T @ tool.r, T @ tool.T
    if not oriented:
        T = identity_orientations(len(r))
        line = None if line is None else (Pose(line[0].r, T[0]), Pose(line[1].r, T[0]))
    found = [] if line is None else [line_deviation(r, T, *line)]
    found += [] if path is None else [path_deviation(r, T, path, oriented=oriented)]
    turned = max(item[1] for item in found) if oriented else None
    return max(item[0] for item in found), turned
