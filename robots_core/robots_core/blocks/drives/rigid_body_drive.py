"""RigidBodyDrive: simulation of controllers, motors, gears, friction and rigid bodies."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.drives import rigid_body_kernel as kernel
from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.errors import InvalidInputError, NotNowError
from robots_core.kernels.chain_dynamics import chain_dynamics_of, mass_matrix_and_bias
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.drive_data import DriveData
from robots_core.validation import Array, finite_vector, positive, read_only

if TYPE_CHECKING:
    from robots_core.blocks.floating_base.floating_base import FloatingBase

# With 0.25 ms the published motion of the Manutec r3 is met to 5e-6 rad; the error falls with the step.
DEFAULT_STEP: Final = 0.25e-3  # s
LONGEST_STEP: Final = 1e-3  # s


class RigidBodyDrive(DriveTrain):
    """A robot moved by its drives: position and speed control, motors, gears, friction, rigid bodies.

    The cascade of the Modelica Standard Library's RobotR3 (P position control with speed feedforward, PI
    speed control, current control) on the dynamics of the robot and its payload, integrated at 1 kHz or
    faster. The step is stable for any gains; axes at rest are held by friction exactly. See
    `rigid_body_kernel`.

    The cascade alone lags, has a steady-state error by the twist of elastic gears, and limit cycles about its
    target where stiction is higher than friction. Industrial controllers feed forward torques and twist by
    the model of the robot, which makes the joints settle at the reference.

    Args:
        robot: The robot.
        q: Joint positions at the start, (n,), rad (m), at rest and held by the motors.
        period: Time of one `step`, s.
        payload: Payload on tool0.
        drives: Controllers, motors and gears; the robot's by default.
        feed_forward: Add motor torques and positions by the robot's model, its payload and friction
            (see `FeedForward`); without, the cascade is that of RobotR3.
        longest_step: Of the integration, s, at most 1 ms; a period is divided into equal ones.
        base: Base of the robot that floats; None for one that stands. Its mass matrix and bias torques are
            then those at the start of each period.

    Raises:
        InvalidInputError: values out of range, a robot without masses, or one whose own dynamics are not
            those of its bodies.
    """

    can_be_pushed = True

    def __init__(
        self,
        robot: BaseRobotModel,
        q: ArrayLike,
        *,
        period: float,
        payload: Payload = NOTHING,
        drives: DriveData | None = None,
        feed_forward: bool = False,
        longest_step: float = DEFAULT_STEP,
        base: FloatingBase | None = None,
    ) -> None:
        n = robot.num_axes
        if not robot.rigid_dynamics_model.masses[1:].any():
            raise InvalidInputError(
                f'robot {robot.name!r} has no masses, which drives of level rigid_body need: its links have '
                'no <inertial>; drives of level second_order or ideal move it'
            )
        self.robot = robot
        self.drives = robot.drive_data if drives is None else drives
        self._drive = self.drives.array
        if self._drive.shape[1] != n:
            raise InvalidInputError(f'drives are for {self._drive.shape[1]} axes, the robot has {n}')
        if positive(longest_step, 'longest_step', 's') > LONGEST_STEP:
            raise InvalidInputError(f'longest_step = {longest_step:g} s must be at most {LONGEST_STEP:g} s')
        self._period = positive(period, 'period', 's')
        self._steps = ceil(period / longest_step * (1.0 - 1e-9))  # no step more for rounding
        self._dynamics = chain_dynamics_of(LoadedRobot(robot, payload)).arrays
        elastic = np.isfinite(self.drives.stiffness)
        self._motors = np.where(elastic, n - 1 + np.cumsum(elastic), np.arange(n)).astype(np.int64)
        self._start, self._end, self._feed = np.zeros((3, 2, n))
        self._outside, self._base = np.zeros(n), base
        self._floating = np.zeros((0, 0) if base is None else (n, n + 1))
        self._state = np.zeros((kernel.STATE_ROWS, n))
        q = finite_vector(q, n, 'q')
        self._feeds_forward = feed_forward
        self._reference = np.array(q)
        self._rest(q)
        # Compiled code is loaded here and not in the first step of a real-time loop.
        self._advance(self._state.copy(), 1)

    def _advance(self, state: Array, steps: int) -> bool:
        """Advance a state by a period; False if a value is no longer finite."""
        return kernel.advance(
            self._dynamics,
            self._drive,
            self._motors,
            state,
            self._start,
            self._end,
            self._feed,
            self._outside,
            self._floating,
            self._period,
            steps,
        )

    def _rest(self, q: Array) -> None:
        """Start at rest at `q`, with all torques in balance with the weight and no friction."""
        n, drives, state = q.size, self.drives, self._state
        M, weight = np.empty((n, n)), np.empty(n)
        mass_matrix_and_bias(self._dynamics, np.array(q), np.zeros(n), M, weight)
        weight -= self._outside
        self._model = FeedForward(self._fill, self.drives, q) if self._feeds_forward else None
        state[kernel.Q] = q
        self.position, self.velocity = read_only(q), read_only(np.zeros(n))
        state[kernel.MOTOR] = q + weight / drives.stiffness
        state[kernel.TORQUE] = state[kernel.JOINT_TORQUE] = weight
        lag = np.where(np.isfinite(drives.current_frequency), drives.current_frequency, 0.0)
        state[kernel.TORQUE_RATE] = 2.0 * drives.current_damping * lag * weight
        if self._model is not None:
            self._feed[1] = drives.coulomb_friction
            self._end[0] = state[kernel.MOTOR]
            return
        # The speed control's integrator balances the weight and the position control's reaction to the twist.
        held = np.divide(weight, drives.velocity_gain, out=np.zeros(n), where=drives.velocity_gain > 0.0)
        state[kernel.INTEGRAL] = held + drives.position_gain * (state[kernel.MOTOR] - q)
        self._end[0] = q

    def rest(self) -> None:
        """See `DriveTrain.rest`."""
        q = self.position
        for values in (self._state, self._end, self._feed):
            values[:] = 0.0
        self._reference = q
        self._rest(q)

    def load(self, payload: Payload) -> None:
        """See `DriveTrain.load`; the feed-forward includes the payload."""
        self._dynamics = chain_dynamics_of(LoadedRobot(self.robot, payload)).arrays
        if self._model is not None:
            self._model.load()

    def push(self, torque: Array) -> None:
        """See `DriveTrain.push`; the feed-forward leaves it out."""
        self._outside[:] = finite_vector(torque, self._outside.size, 'torque')

    def apply_impact(self, q_dot: Array) -> None:
        """See `DriveTrain.apply_impact`; behind an elastic gear the motor keeps its speed."""
        self._state[kernel.Q_DOT], self._state[kernel.Q_DDOT] = q_dot, 0.0
        rigid = np.isinf(self.drives.stiffness)
        self._state[kernel.MOTOR_DOT, rigid] = q_dot[rigid]
        self.velocity = read_only(self._state[kernel.Q_DOT])

    @property
    def impact_inertia(self) -> Array:
        """See `DriveTrain.impact_inertia`."""
        return np.where(np.isinf(self.drives.stiffness), self.drives.inertia, 0.0)

    def _fill(self, q: Array, q_dot: Array, M: Array, bias: Array) -> None:
        if self._base is None:
            mass_matrix_and_bias(self._dynamics, q, q_dot, M, bias)
        else:
            M[:], bias[:] = self._base.joint_dynamics(q, q_dot)

    @property
    def torque(self) -> Array:
        """See `DriveTrain.torque`."""
        return read_only(self._state[kernel.TORQUE])

    @property
    def joint_torque(self) -> Array:
        """Torques behind gears, rotors and friction, that move the bodies, (n,), N m (N), read-only."""
        return read_only(self._state[kernel.JOINT_TORQUE])

    @property
    def motor_position(self) -> Array:
        """Positions of the motors through their gears, (n,), rad (m), read-only."""
        return read_only(self._state[kernel.MOTOR])

    def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
        """See `DriveTrain.step`; between the last reference and this one the drives interpolate by a cubic.

        Raises:
            InvalidInputError: a reference of another shape or not finite.
            RobotsError: the state is no longer finite.
        """
        n = self._end.shape[1]
        q_ref = finite_vector(q_ref, n, 'q_ref')
        before, self._reference = self._reference, np.array(q_ref)
        velocity = (
            (q_ref - before) / self._period if q_dot_ref is None else finite_vector(q_dot_ref, n, 'q_dot_ref')
        )
        self._start[:] = self._end
        if self._model is None:
            self._end[0], self._end[1] = q_ref, velocity
        else:
            self._end[0], self._end[1], self._feed[0] = self._model.advance(q_ref, velocity, self._period)
        if self._base is not None:
            M, bias = self._base.joint_dynamics(self.position, self.velocity)
            self._floating[:, :n], self._floating[:, n] = M, bias
        if not self._advance(self._state, self._steps):
            raise NotNowError(
                f'the drives of robot {self.robot.name!r} lost their state: not finite any more'
            )
        self.position, self.velocity = read_only(self._state[kernel.Q]), read_only(self._state[kernel.Q_DOT])
        return self.position, self.velocity


class FeedForward:
    """Torques and leads of the motors for a reference of the joints, period by period.

    The torque is (M + rotors) q_ddot + tau_aux + viscous q_dot. The motor of an elastic gear leads its joint
    by the twist that moves it, (M q_ddot + tau_aux) / stiffness (Spong 1987, first order in the twist).

    Args:
        fill: Fills mass matrix (n, n) and bias torques (n,) of the bodies at q, q_dot.
        drives: Motors and gears.
        q: Reference at the start, (n,), rad (m), at rest.
    """

    def __init__(
        self, fill: Callable[[Array, Array, Array, Array], object], drives: DriveData, q: Array
    ) -> None:
        self._drives, self._fill = drives, fill
        n = q.size
        self._M, self._bias = np.empty((n, n)), np.empty(n)
        self._q, self._q_dot = np.array(q), np.zeros(n)
        self.load()

    def load(self) -> None:
        """Take other bodies over; the reference stands."""
        self._fill(self._q, self._q_dot, self._M, self._bias)
        self._twist = self._bias / self._drives.stiffness

    def advance(self, q: Array, q_dot: Array, period: float) -> tuple[Array, Array, Array]:
        """Advance to the reference (n,) at the end of a period, s.

        Returns:
            Position and velocity of the motors there, (n,), through their gears, and the mean torque of the
            period, (n,), N m (N).
        """
        q_ddot = (q_dot - self._q_dot) / period
        speed = 0.5 * (self._q_dot + q_dot)
        start = self._M @ q_ddot + self._bias
        self._q[:], self._q_dot[:] = q, q_dot
        self._fill(self._q, self._q_dot, self._M, self._bias)
        end = self._M @ q_ddot + self._bias
        torque = 0.5 * (start + end) + self._drives.inertia * q_ddot + self._drives.viscous_friction * speed
        before, self._twist = self._twist, end / self._drives.stiffness
        return q + self._twist, q_dot + (self._twist - before) / period, torque
