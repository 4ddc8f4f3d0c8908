"""TumblingBody: a rigid body that no force acts on, such as a satellite out of control."""

from math import ceil
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector, positive, read_only

# The error falls with the fourth power: at 1 rad/s it is below 1e-12 rad per second of motion.
LONGEST_STEP: Final = 5e-3  # s


class TumblingBody:
    """Free motion of a rigid body, whose moments of inertia may all differ.

    The state is the pose and the momentum, which is constant and so kept exactly. The orientation follows
    from it, T' = T [I^-1 T^T L]x (Euler), by the classical Runge-Kutta method on rotations (Munthe-Kaas
    1999). The closed form by elliptic functions (Landau and Lifshitz, Mechanics, paragraph 37) is its test.

    Args:
        body: Mass and inertia, with the centre of mass in the body's frame.
        pose: Of the body's frame in the world at the start.
        velocity: Of the centre of mass, (3,), m/s, world axes.
        angular_velocity: (3,), rad/s, in the body's axes.

    Raises:
        InvalidInputError: a body without mass or inertia, or values of another shape or not finite.
    """

    def __init__(
        self,
        body: Payload,
        pose: Pose,
        *,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        angular_velocity: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        if not (body.mass > 0.0 and np.linalg.eigvalsh(body.inertia)[0] > 0.0):
            raise InvalidInputError('a body that tumbles needs a mass and three moments of inertia above 0')
        self.body = body
        self._inverse = np.linalg.inv(body.inertia)
        self._T = np.array(pose.T)
        self._r = pose.r + pose.T @ body.center
        self._p = body.mass * finite_vector(velocity, 3, 'velocity')
        self._L = self._T @ body.inertia @ finite_vector(angular_velocity, 3, 'angular_velocity')

    @property
    def pose(self) -> Pose:
        """Pose of the body's frame in the world."""
        return Pose(self._r - self._T @ self.body.center, self._T)

    @property
    def angular_velocity(self) -> Array:
        """(3,), rad/s, world axes."""
        return np.asarray(self._T @ self._rate(self._T))

    @property
    def center_of_mass(self) -> Array:
        """(3,), m, in the world, read-only."""
        return read_only(self._r)

    @property
    def momentum(self) -> Array:
        """Linear momentum (N s), then angular momentum about the world's origin (N m s), (6,), world axes."""
        return np.concatenate([self._p, self._L + pin.skew(self._r) @ self._p])

    def velocity_at(self, point: Array) -> Array:
        """Velocity (3,), m/s, world axes, of the body's point that is at `point` (3,), m, in the world."""
        return np.asarray(self._p / self.body.mass + pin.skew(self.angular_velocity) @ (point - self._r))

    def carry(self, pose: Pose, twist: Array) -> None:
        """Move as something that holds the body moves it.

        Args:
            pose: Of the body's frame in the world.
            twist: Velocity of its origin (m/s) and angular velocity (rad/s), (6,), world axes.
        """
        self._T = np.array(pose.T)
        arm = pose.T @ self.body.center
        self._r = pose.r + arm
        self._p = self.body.mass * (twist[:3] + pin.skew(twist[3:]) @ arm)
        self._L = self._T @ self.body.inertia @ self._T.T @ twist[3:]

    def step(self, period: float) -> None:
        """Advance by a period, s, in steps of at most 5 ms.

        Raises:
            InvalidInputError: a period not above zero.
        """
        steps = ceil(positive(period, 'period', 's') / LONGEST_STEP * (1.0 - 1e-9))
        h = period / steps
        for _ in range(steps):
            self._turn(h)
        self._r = self._r + period / self.body.mass * self._p

    def _turn(self, h: float) -> None:
        d1 = self._rate(self._T)
        d2 = self._displacement_rate(0.5 * h * d1)
        d3 = self._displacement_rate(0.5 * h * d2)
        d4 = self._displacement_rate(h * d3)
        turned = self._T @ pin.exp3(h / 6.0 * (d1 + 2.0 * d2 + 2.0 * d3 + d4))
        self._T = np.asarray(pin.Quaternion(turned).normalized().toRotationMatrix())

    def _rate(self, T: Array) -> Array:
        """Angular velocity (3,) in the axes of the body with an orientation."""
        return np.asarray(self._inverse @ (T.T @ self._L))

    def _displacement_rate(self, moved: Array) -> Array:
        step = pin.exp3(moved)
        return np.asarray(pin.Jlog3(step) @ self._rate(self._T @ step))
