"""ConstrainedInverseKinematics: follow a reference pose inside all limits (the paper's block)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_core.blocks.inverse_kinematics.constrained_kernel import NOT_FINITE, constrained_step
from robots_core.blocks.inverse_kinematics.hold import held_by, weights_of
from robots_core.blocks.inverse_kinematics.quadratic_program import SOLVED
from robots_core.blocks.inverse_kinematics.redundancy import (
    PREFERRED_POSITIONS,
    Redundancy,
    redundancy_arrays,
)
from robots_core.errors import InvalidInputError
from robots_core.files.content_cache import content_of, kept
from robots_core.kernels.chain_dynamics import NO_DYNAMICS, ChainDynamics
from robots_core.kernels.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, positive, read_only

Quantity = Literal['position', 'velocity', 'acceleration', 'torque']
QUANTITIES: dict[int, Quantity] = {1: 'position', 2: 'velocity', 3: 'acceleration'}


@dataclass(frozen=True)
class ActiveLimit:
    """A limit that kept the robot from following more closely.

    Attributes:
        joint: The axis' name.
        quantity: The limited quantity; 'position' also while the axis brakes for its position limit.
        side: The end of the range.
    """

    joint: str
    quantity: Quantity
    side: Literal['lower', 'upper']


@dataclass(frozen=True, eq=False, slots=True)
class ConstrainedStep:
    """Joint motion of one period with constant acceleration, with errors and slacks.

    Attributes:
        values: (4, n), read-only: the rows `q`, `q_dot`, `q_ddot`, `torque`.
        slack: By how much a limit of positions, velocities or torques is or will be broken at most, relative
            to it (positions: to the range); 0 unless the step began in a state from which it cannot be kept.
        position_error: Distance to the reference at the end of the period, m.
        orientation_error: Angle to the reference at the end of the period, rad.
        solved: False if the quadratic program did not converge; the robot then brakes.
        active: (2, n): per axis what bounds its velocity (1 position, 2 velocity, 3 acceleration) and whether
            its torque is bounded (1); the sign is the side, 0 nothing.
        names: Of the axes.
    """

    values: Array
    slack: float
    position_error: float
    orientation_error: float
    solved: bool
    active: NDArray[np.int64]
    names: tuple[str, ...]

    @property
    def active_limits(self) -> tuple[ActiveLimit, ...]:
        """Active limits, which cost accuracy."""
        found: list[ActiveLimit] = []
        for name, bound, torque in zip(self.names, *self.active.tolist(), strict=True):
            if bound:
                found.append(ActiveLimit(name, QUANTITIES[abs(bound)], 'upper' if bound > 0 else 'lower'))
            if torque:
                found.append(ActiveLimit(name, 'torque', 'upper' if torque > 0 else 'lower'))
        return tuple(found)

    @property
    def q(self) -> Array:
        """Joint positions at the end of the period, (n,), rad (m)."""
        return np.asarray(self.values[0])

    @property
    def q_dot(self) -> Array:
        """Joint velocities at the end of the period, (n,), rad/s."""
        return np.asarray(self.values[1])

    @property
    def q_ddot(self) -> Array:
        """Joint accelerations during the period, (n,), rad/s^2."""
        return np.asarray(self.values[2])

    @property
    def torque(self) -> Array:
        """Torques at the start of the period, M q_ddot + tau_aux, (n,), N m."""
        return np.asarray(self.values[3])


DEFAULT_GAIN = 0.5  # of the pose error per period
TORQUE_SAMPLES = 1500
# The largest torque of a braking robot is found by sampling; this fraction of the margin is kept in reserve.
TORQUE_RESERVE = 0.05
# Smallest fraction of the acceleration limits for braking. An arm whose motors hardly hold it at full speed
# could not move near its limits with less; the missing torque shows as torque slack.
SMALLEST_BRAKING = 0.3
NO_TWIST = np.zeros(6)


class ConstrainedInverseKinematics:
    """Joint motion that follows a reference pose as closely as all limits of the axes allow.

    In every period dt the velocities w that the axes have at its end minimise::

        |W (J w - V - k e)|^2 + rho |w - p|^2

    subject to the limits, by a small quadratic program (the idea of Bellmann, Otter and Hirzinger 2011, The
    DLR robot motion simulator part II, as the paper describes it). e is the pose error that remains if the
    robot moves like the reference from now on, V the reference's twist, and k shrinks with the distance so
    that every axis can stop when it arrives; p is the velocity of a redundancy criterion. Axes have constant
    acceleration within a period, so that limits kept at its ends are kept in it.

    Position limits are kept by viability (see `viability`): a state from which all axes can brake before
    their limits is followed by such a state, whatever the reference does. Braking uses the deceleration that
    the torques allow everywhere, found once by sampling the workspace (`deceleration`). If the limits
    contradict each other in a given state, acceleration has priority, then braking for the position limit,
    then torques, with the smallest overload; `slack` is the amount.

    The quadratic program is solved by a dual active-set method of our own (`quadratic_program`), compiled
    together with the rest of the step. `make benchmark-inverse-kinematics` times it against others on the
    same programs of 7 variables, each called from Python (2026-11-22, two shared cores): ours 7 us, daqp 13,
    quadprog 19, piqp 29, proxsuite 95. An external solver would split the step in two
    compiled halves with Python between them; ours needs no further package.

    A step depends on its arguments alone. An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        dt: Period, s.
        tool: Pose of the tool centre point in tool0, which follows the reference; tool0 itself by default.
        weights: Of position (per m) and orientation (per rad) if both are not reachable; 0 leaves one free.
            By default those of what the arm can hold, see `held_by`.
        gain: Fraction of the pose error removed per second, 1/s, at most 1/dt; 0.5/dt by default.
        redundancy: Secondary criterion for the degrees of freedom that the pose leaves; none by default.

    Raises:
        InvalidInputError: an option out of its range, or an axis whose range is too short to stop in.
        JointLimitError: the preferred positions of the redundancy criterion lie outside the limits.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        dt: float,
        *,
        tool: Pose | None = None,
        weights: tuple[float, float] | None = None,
        gain: float | None = None,
        redundancy: Redundancy | None = None,
    ) -> None:
        self.robot = robot
        self.dt = positive(dt, 'dt', 's')
        axes = robot.axes_data
        gain = DEFAULT_GAIN / dt if gain is None else positive(gain, 'gain', '1/s')
        if gain * dt > 1.0:
            raise InvalidInputError(f'gain = {gain:g} 1/s must be at most 1/dt = {1.0 / dt:g} 1/s')
        if weights is None:
            weights = weights_of(held_by(axes.num_axes))
        if not (min(weights) >= 0.0 and 0.0 < max(weights) < np.inf):
            raise InvalidInputError(
                f'weights {weights} must be finite, not negative and not both 0: (per m, per rad)'
            )
        self.deceleration = braking_deceleration(robot)
        """Of every axis when all brake, (n,), rad/s^2: inside the torque limits for all joint positions."""
        self._limits = np.array(
            [axes.lower, axes.upper, axes.velocity, axes.acceleration, self.deceleration, axes.effort]
        )
        self._options = np.array([dt, gain, *weights])
        chain = SerialChain.of(robot, tool)
        self._fixed = (chain.arrays, self._limits, self._options, redundancy_arrays(redundancy, axes))
        dynamics = ChainDynamics.of(robot)
        self._dynamics = NO_DYNAMICS if dynamics is None else dynamics.arrays
        self._names = axes.names
        self._shape = (axes.num_axes,)
        self._still = np.zeros(self._shape)
        self._errors = np.empty(3)
        self._M, self._tau_aux = np.empty(2 * self._shape), np.empty(self._shape)
        self._q, self._q_dot = np.empty(self._shape), np.empty(self._shape)
        self._r, self._T, self._twist = np.empty(3), np.empty((3, 3)), np.empty(6)
        # Compiled code is loaded here and not in the first step of a real-time loop.
        self.step(Pose(chain.r, chain.T), robot.home, self._still)

    def step(
        self, pose: Pose, q: ArrayLike, q_dot: ArrayLike, twist: ArrayLike | None = None
    ) -> ConstrainedStep:
        """Joint motion of the next period.

        Args:
            pose: Reference pose of the tool centre point at the end of the period, base frame.
            q: Joint positions now, (n,), rad (m): of the last step, or of the robot at the start.
            q_dot: Joint velocities now, (n,), rad/s.
            twist: Twist of the reference at the end of the period, (6,): velocity (m/s), angular velocity
                (rad/s), base frame; at rest by default, which causes a lag behind a moving reference.

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """
        q, q_dot = np.asarray(q, dtype=np.float64), np.asarray(q_dot, dtype=np.float64)
        v = NO_TWIST if twist is None else np.asarray(twist, dtype=np.float64)
        shape = self._shape
        if q.shape != shape or q_dot.shape != shape or v.shape != (6,):
            self._refuse(q, q_dot, v)
        # Compiled code is specialised for one memory layout; another would take many seconds to compile.
        self._q[:], self._q_dot[:] = q, q_dot
        self._r[:], self._T[:], self._twist[:] = pose.r, pose.T, v
        M, tau_aux, errors = self._M, self._tau_aux, self._errors
        if self._dynamics is NO_DYNAMICS:
            _, M[:], tau_aux[:] = self.robot.rigid_dynamics(q, q_dot, self._still)
        values, active = np.empty((4, *shape)), np.empty((2, *shape), dtype=np.int64)
        status = constrained_step(
            *self._fixed,
            self._dynamics,
            (self._q, self._q_dot, M, tau_aux),
            (self._r, self._T, self._twist),
            (values, errors, active),
        )
        if status == NOT_FINITE:
            self._refuse(q, q_dot, v)
        values.flags.writeable = False
        position_error, orientation_error, slack = errors.tolist()
        return ConstrainedStep(
            values, slack, position_error, orientation_error, status == SOLVED, active, self._names
        )

    def prefer(self, q: ArrayLike) -> None:
        """Stay near other joint positions from now on, (n,) rad (m), where the redundancy criterion has such.

        Raises:
            JointLimitError: they lie outside the limits.
            InvalidInputError: they have another shape or are not finite.
        """
        if self._fixed[3][0] == PREFERRED_POSITIONS:
            self._fixed[3][1][:] = self.robot.axes_data.check_position(q, 'preferred')

    def _refuse(self, q: Array, q_dot: Array, twist: Array) -> None:
        """Raise the error for invalid arguments of a step."""
        finite_vector(q, self._shape[0], 'q')
        finite_vector(q_dot, self._shape[0], 'q_dot')
        finite_vector(twist, 6, 'twist')


def braking_deceleration(robot: BaseRobotModel) -> Array:
    """Decelerations that all axes can have at once inside their torque limits, (n,), rad/s^2.

    The acceleration limits, all scaled by the fraction that the torques allow in the worst of many random
    states at up to full speed; each axis may brake or have stopped already. They are kept by content.
    """
    dynamics = ChainDynamics.of(robot)
    if dynamics is None:
        return _sampled_braking(robot, lambda q, q_dot: robot.rigid_dynamics(q, q_dot, np.zeros_like(q))[1:])
    axes = robot.axes_data
    limits = (*axes.one_turn, axes.velocity, axes.acceleration, axes.effort)
    sampling = (TORQUE_SAMPLES, TORQUE_RESERVE, SMALLEST_BRAKING)
    arrays = kept(
        'braking',
        content_of((*sampling, *dynamics.arrays, *limits)),
        lambda: {'deceleration': _sampled_braking(robot, dynamics.mass_matrix_and_bias)},
    )
    return read_only(arrays['deceleration'])


def _sampled_braking(
    robot: BaseRobotModel, mass_matrix_and_bias: Callable[[Array, Array], tuple[Array, Array]]
) -> Array:
    axes = robot.axes_data
    low, high = axes.one_turn
    rng = np.random.default_rng(0)
    n = axes.num_axes
    M, tau_aux = np.empty((TORQUE_SAMPLES, n, n)), np.empty((TORQUE_SAMPLES, n))
    turning = np.empty((TORQUE_SAMPLES, 1, n))
    for sample in range(TORQUE_SAMPLES):
        q = rng.uniform(low, high)
        q_dot = axes.velocity * (
            2.0 * rng.integers(0, 2, n) - 1.0 if sample % 2 else rng.uniform(-1.0, 1.0, n)
        )
        turning[sample, 0] = np.sign(q_dot)
        M[sample], tau_aux[sample] = mass_matrix_and_bias(q, q_dot)
    torques = -M * (turning * axes.acceleration)
    up, down = np.maximum(torques, 0.0).sum(axis=2), np.maximum(-torques, 0.0).sum(axis=2)
    room = (1.0 - TORQUE_RESERVE) * axes.effort
    rising, falling = (room - tau_aux) / np.maximum(up, 1e-12), (room + tau_aux) / np.maximum(down, 1e-12)
    part = min(1.0, float(rising.min()), float(falling.min()))
    return np.asarray(max(part, SMALLEST_BRAKING) * axes.acceleration)
