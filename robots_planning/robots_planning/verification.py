"""Verification: an independent look at a trajectory, whoever planned it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose, rotation_vector
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only
from robots_planning.trajectory import Trajectory

SAMPLE_PERIOD = 1e-3  # s
DYNAMICS_PERIOD = 4e-3  # s, the controller's; torque changes slowly against it
RATIO_TOLERANCE = 1e-3  # of a limit: what finite differences at the sample period can tell
POSITION_TOLERANCE = 1e-9  # rad (m), as the axis limits' own check
REST_TOLERANCE = 1e-6  # of the velocity and acceleration limits, at both ends
LINE_TOLERANCE = 1e-5  # m and rad


@dataclass(frozen=True)
class LimitUse:
    """The worst use of one kind of limit.

    Attributes:
        quantity: 'position', 'velocity', 'acceleration', 'jerk' or 'torque'.
        ratio: Value over limit; for position 1 at a bound, 0 in the middle of the range.
        joint: Where.
        time: When, s.
        value: SI.
        limit: The bound, SI.
        unit: Of both.
    """

    quantity: str
    ratio: float
    joint: str
    time: float
    value: float
    limit: float
    unit: str

    def describe(self) -> str:
        """One line for a person."""
        return (
            f'{self.joint} {self.quantity} {self.value:.6g} {self.unit} at {self.time:.3f} s passes its '
            f'limit {self.limit:.6g} {self.unit} ({100.0 * self.ratio:.2f} %)'
        )


@dataclass(frozen=True, eq=False)
class VerificationReport:
    """What `verify` found.

    Attributes:
        duration: Of the trajectory, s.
        uses: Worst use by quantity: position, velocity, acceleration, jerk, and torque if it was asked for.
        axis_use: By quantity, worst ratio of every axis, (n,).
        outside: How far positions pass the axis limits, rad (m); negative is the margin left.
        start_motion: Velocity or acceleration at the start, as part of its limit; 0 is rest.
        end_motion: The same at the end.
        line_deviation: Largest distance of the tool from the line and of its ends from the line's, m; None
            without a line.
        orientation_deviation: Largest angle between the tool and the rotation about the line's one axis, rad.
    """

    duration: float
    uses: dict[str, LimitUse]
    axis_use: dict[str, Array]
    outside: float
    start_motion: float
    end_motion: float
    line_deviation: float | None = None
    orientation_deviation: float | None = None
    violations: tuple[str, ...] = field(init=False)
    """One line per limit that is broken. Jerk is told in `uses`, and breaks nothing."""

    def __post_init__(self) -> None:
        object.__setattr__(self, 'violations', tuple(self._violations()))

    def _violations(self) -> list[str]:
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
            f'the trajectory does not {verb} at rest: it moves at {100.0 * motion:.3g} % of a limit'
            for verb, motion in (('start', self.start_motion), ('end', self.end_motion))
            if motion > REST_TOLERANCE
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
        return lines

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


class _Samples(NamedTuple):
    """Times (m,) or (m, n), use of the limits (m, n), values (m, n), and limits, of one quantity."""

    t: Array
    ratio: Array
    value: Array
    limit: Array


def verify(
    trajectory: Trajectory,
    robot: BaseRobotModel,
    *,
    line: tuple[Pose, Pose] | None = None,
    torque: bool = True,
) -> VerificationReport:
    """Compare a trajectory with all limits of a robot, without knowing how it was planned.

    Positions are sampled at 1 kHz and differentiated by central differences; velocity and acceleration of
    the trajectory itself are taken at the same instants and at every extreme of acceleration between its
    points. Torques come from inverse dynamics at 250 Hz.

    Args:
        trajectory: What to look at.
        robot: Whose limits hold.
        line: First and last pose of a straight tool line with rotation about one axis to stay on.
        torque: Compute torques too.

    Raises:
        InvalidInputError: the trajectory has another number of axes than the robot.
    """
    axes = robot.axes_data
    if trajectory.num_axes != axes.num_axes:
        raise InvalidInputError(
            f'the trajectory has {trajectory.num_axes} axes, robot {robot.name} has {axes.num_axes}'
        )
    count = int(np.ceil(trajectory.duration / SAMPLE_PERIOD)) + 1
    t = np.union1d(np.linspace(0.0, trajectory.duration, max(count, 16)), trajectory.time)
    q, q_dot, q_ddot = trajectory.sample(t)
    before, after = (trajectory.sample(t + sign * SAMPLE_PERIOD)[0] for sign in (-1.0, 1.0))
    # A difference is an average of what it stands for, so it can only understate a limit that is broken.
    velocity = np.maximum(np.abs(q_dot), np.abs(after - before) / (2.0 * SAMPLE_PERIOD))
    acceleration = np.maximum(np.abs(q_ddot), np.abs(after - 2.0 * q + before) / SAMPLE_PERIOD**2)
    extreme_times, extremes, jerks = trajectory.acceleration_extremes()

    middle, half = _range(axes.lower, axes.upper)
    ratios = {
        'position': _Samples(t, np.abs(q - middle) / half, q, np.where(q < middle, axes.lower, axes.upper)),
        'velocity': _Samples(t, velocity / axes.velocity, velocity, axes.velocity),
        'acceleration': _Samples(
            np.concatenate([np.broadcast_to(t[:, None], q.shape), extreme_times]),
            np.concatenate([acceleration, extremes]) / axes.acceleration,
            np.concatenate([acceleration, extremes]),
            axes.acceleration,
        ),
        'jerk': _Samples(extreme_times, jerks / axes.jerk, jerks, axes.jerk),
    }
    if torque:
        ratios['torque'] = _torques(trajectory, robot)
    deviation, turned = (None, None) if line is None else _line_deviation(trajectory, robot, line)
    return VerificationReport(
        duration=trajectory.duration,
        uses={quantity: _worst(quantity, robot, values) for quantity, values in ratios.items()},
        axis_use={quantity: read_only(values.ratio.max(axis=0)) for quantity, values in ratios.items()},
        outside=float(np.maximum(axes.lower - q, q - axes.upper).max()),
        start_motion=_motion(trajectory, robot, 0),
        end_motion=_motion(trajectory, robot, -1),
        line_deviation=deviation,
        orientation_deviation=turned,
    )


def _range(lower: Array, upper: Array) -> tuple[Array, Array]:
    """Middle and half width of the position limits; a continuous axis is never near one."""
    bounded = np.isfinite(lower) & np.isfinite(upper)
    low, high = np.where(bounded, lower, -1.0), np.where(bounded, upper, 1.0)
    return np.where(bounded, 0.5 * (low + high), 0.0), np.where(bounded, 0.5 * (high - low), np.inf)


def _worst(quantity: str, robot: BaseRobotModel, samples: _Samples) -> LimitUse:
    t, ratio, value, limit = samples
    row, axis = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    position = 'm' if robot.axes_data.prismatic[axis] else 'rad'
    units = {'position': '', 'velocity': '/s', 'acceleration': '/s^2', 'jerk': '/s^3'}
    force = 'N' if robot.axes_data.prismatic[axis] else 'N m'
    return LimitUse(
        quantity=quantity,
        ratio=float(ratio[row, axis]),
        joint=robot.axes_data.names[axis],
        time=float(t[row] if t.ndim == 1 else t[row, axis]),
        value=float(value[row, axis]),
        limit=float(np.broadcast_to(limit, ratio.shape)[row, axis]),
        unit=force if quantity == 'torque' else position + units[quantity],
    )


def _torques(trajectory: Trajectory, robot: BaseRobotModel) -> _Samples:
    count = int(np.ceil(trajectory.duration / DYNAMICS_PERIOD)) + 1
    t = np.linspace(0.0, trajectory.duration, max(count, 5))
    model = robot.rigid_dynamics_model
    tau = np.abs([model.torques(*state) for state in zip(*trajectory.sample(t), strict=True)])
    return _Samples(t, tau / robot.axes_data.effort, tau, robot.axes_data.effort)


def _motion(trajectory: Trajectory, robot: BaseRobotModel, row: int) -> float:
    axes = robot.axes_data
    return float(
        max(
            (np.abs(trajectory.velocity[row]) / axes.velocity).max(),
            (np.abs(trajectory.acceleration[row]) / axes.acceleration).max(),
        )
    )


def _line_deviation(
    trajectory: Trajectory, robot: BaseRobotModel, line: tuple[Pose, Pose]
) -> tuple[float, float]:
    """Largest distance (m) and angle (rad) of the tool from the line, its ends included."""
    # Interpolation errors are largest in the middle between points.
    middles = 0.5 * (trajectory.time[:-1] + trajectory.time[1:])
    t = np.union1d(np.linspace(0.0, trajectory.duration, 101), middles)
    frames = [robot.direct_kinematics(q) for q in trajectory.sample(t)[0]]
    r = np.array([frame[0] for frame in frames])
    T = np.array([frame[1] for frame in frames])
    start, end = line

    along = end.r - start.r
    squared = float(along @ along)
    part = np.clip((r - start.r) @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(r))
    distance = np.linalg.norm(r - start.r - part[:, None] * along, axis=1)

    turn = rotation_vector(end.T @ start.T.T)
    angle = float(np.linalg.norm(turn))
    k = turn / angle if angle > 0.0 else np.zeros(3)
    quaternion = Rotation.from_matrix(T @ start.T.T).as_quat(canonical=True)
    across = quaternion[:, :3] - (quaternion[:, :3] @ k)[:, None] * k
    away = 2.0 * np.arcsin(np.minimum(np.linalg.norm(across, axis=1), 1.0))

    ends = [Pose(r[row], T[row]).distance_to(pose) for row, pose in ((0, start), (-1, end))]
    return (
        max(float(distance.max()), *(end[0] for end in ends)),
        max(float(away.max()), *(end[1] for end in ends)),
    )
