"""FeedForward: motor torques and positions for a reference, from the model of the robot."""

from collections.abc import Callable

import numpy as np

from robots_core.robot_model.drive_data import DriveData
from robots_core.validation import Array


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
