"""FreeFloatingRobot: a robot on a floating base, such as a satellite."""

from math import ceil
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robots_core.blocks.multibody.free_floating_dynamics import check_base_body
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, positive, read_only

# The method's error falls with the fourth power: at swings of 1 rad/s it is some 1e-11 of the momentum.
LONGEST_STEP: Final = 5e-3  # s


class FreeFloatingRobot:
    """Simulates base and joints of a robot that floats, driven by torques in its joints.

    Forward dynamics by the articulated body algorithm on the floating base (Featherstone 2008), integrated by
    the classical Runge-Kutta method on displacements (Munthe-Kaas 1999) and velocities. The robot's gravity
    acts on base and arm alike, along its direction for an upright base; load the robot with gravity zero for
    one in orbit. Joint friction and rotors are omitted: both are internal and change no momentum.

    Args:
        robot: The robot; its base body needs a mass and an inertia.
        q: Joint positions at the start, (n,), rad (m); the base is at the world's origin.
        q_dot: Joint velocities at the start, (n,), rad/s; at rest by default.
        twist: Velocity of the base (m/s), then angular velocity (rad/s), (6,), in base axes.
        payload: Payload on tool0.

    Raises:
        InvalidInputError: a base without mass or inertia, or values of another shape or not finite.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        q: ArrayLike,
        *,
        q_dot: ArrayLike | None = None,
        twist: ArrayLike | None = None,
        payload: Payload = NOTHING,
    ) -> None:
        n = robot.num_axes
        check_base_body(robot)
        self.robot = robot
        self._n = n
        numerical = NumericalDynamics(robot, payload=payload, rotors=False)
        self.model = numerical.model
        self.model.gravity.linear = numerical.gravity
        self._data = self.model.createData()
        self._configuration = pin.neutral(self.model)  # its base at the world's origin
        self._configuration[7:] = finite_vector(q, n, 'q')
        self._velocity = np.zeros(6 + n)
        if twist is not None:
            self._velocity[:6] = finite_vector(twist, 6, 'twist')
        if q_dot is not None:
            self._velocity[6:] = finite_vector(q_dot, n, 'q_dot')

    @property
    def position(self) -> Array:
        """Joint positions, (n,), rad (m), read-only."""
        return read_only(self._configuration[7:])

    @property
    def velocity(self) -> Array:
        """Joint velocities, (n,), rad/s, read-only."""
        return read_only(self._velocity[6:])

    @property
    def base_pose(self) -> Pose:
        """Pose of the base in the world."""
        return Pose.from_quaternion(self._configuration[:3], self._configuration[3:7])

    @property
    def base_twist(self) -> Array:
        """Velocity (m/s) and angular velocity (rad/s) of the base, (6,), base axes, read-only."""
        return read_only(self._velocity[:6])

    @property
    def momentum(self) -> Array:
        """Linear (N s) and angular (N m s) momentum about the common centre of mass, (6,), world axes."""
        pin.computeCentroidalMomentum(self.model, self._data, self._configuration, self._velocity)
        return np.concatenate([self._data.hg.linear, self._data.hg.angular])

    @property
    def kinetic_energy(self) -> float:
        """J."""
        return float(pin.computeKineticEnergy(self.model, self._data, self._configuration, self._velocity))

    def step(self, tau: ArrayLike, period: float) -> tuple[Array, Array]:
        """Advance with constant torques in the joints.

        Args:
            tau: Torques, (n,), N m (N).
            period: s; divided into steps of at most 5 ms.

        Returns:
            Joint positions and velocities (n,) at the end of the period.

        Raises:
            InvalidInputError: torques of another shape or not finite, or a period not above zero.
        """
        generalized = np.concatenate([np.zeros(6), finite_vector(tau, self._n, 'tau')])
        steps = ceil(positive(period, 'period', 's') / LONGEST_STEP * (1.0 - 1e-9))
        h = period / steps
        for _ in range(steps):
            self._runge_kutta(generalized, h)
        return self.position, self.velocity

    def _runge_kutta(self, tau: Array, h: float) -> None:
        v, still = self._velocity, np.zeros_like(self._velocity)
        d1, v1 = self._rates(still, v, tau)
        d2, v2 = self._rates(0.5 * h * d1, v + 0.5 * h * v1, tau)
        d3, v3 = self._rates(0.5 * h * d2, v + 0.5 * h * v2, tau)
        d4, v4 = self._rates(h * d3, v + h * v3, tau)
        step = h / 6.0 * (d1 + 2.0 * d2 + 2.0 * d3 + d4)
        self._configuration = np.asarray(pin.integrate(self.model, self._configuration, step))
        self._velocity = v + h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)

    def _rates(self, moved: Array, v: Array, tau: Array) -> tuple[Array, Array]:
        """Rates of the displacement (6 + n,) since the step began, and of the velocity (6 + n,)."""
        rate = np.array(v)
        rate[:6] = pin.Jlog6(pin.exp6(moved[:6])) @ v[:6]
        configuration = pin.integrate(self.model, self._configuration, moved)
        return rate, np.asarray(pin.aba(self.model, self._data, configuration, v, tau))
