"""ReparametrisedPath: a joint path over a coordinate along which the axes move at about constant speed."""

import numpy as np

from robots_core.validation import Array
from robots_planning.paths.joint_path import JointPath
from robots_planning.paths.path_grid import path_grid
from robots_planning.timing.quintic import quintic_coefficients, quintics_at

NODES = 4  # per interval between two samples of the path
SMALLEST_LENGTH = 1e-12  # s at full speed; a shorter path is one at rest
SLOWEST_TURN = 0.05  # of the mean rate; slower axes have no meaningful direction


class ReparametrisedPath:
    """A joint path over a coordinate sigma from 0 to 1, twice continuously differentiable.

    Close to a singularity the axes do most of their motion within a small part of s. There their
    accelerations are small differences of large terms, q'' s_dot^2 and q' s_ddot, and a speed profile over s
    is coarse. With

        d sigma / ds ~ sqrt(1 + (rate / mean rate)^2),

    where the rate is the norm of q' divided by the axes' speed limits, q' is bounded over sigma, and both
    problems disappear.

    Args:
        path: The joint path, over s.
        velocity: Speed limits of the axes, (n,), rad/s (m/s), by which q' is scaled.
        acceleration: Acceleration limits of the axes, (n,), rad/s^2 (m/s^2).
    """

    def __init__(self, path: JointPath, velocity: Array, acceleration: Array) -> None:
        self._path = path
        parts = np.arange(NODES) / NODES
        self._s = np.append((path.s[:-1, None] + np.diff(path.s)[:, None] * parts).ravel(), 1.0)
        _, q_s, q_ss = path.evaluate(self._s)
        first, second = q_s / velocity, q_ss / velocity
        square, product = np.einsum('mk,mk->m', first, first), np.einsum('mk,mk->m', first, second)
        mean = max(float(self._integral(np.sqrt(square))[-1]), SMALLEST_LENGTH)
        slope = np.sqrt(1.0 + square / mean**2)
        change = product / (mean**2 * slope)
        steps = np.diff(self._s)
        sigma = self._integral(slope)
        # Correction from the trapezoidal rule to the integral of Hermite cubics.
        sigma[1:] += np.cumsum(steps**2 / 12.0 * (change[:-1] - change[1:]))
        whole = float(sigma[-1])
        self._sigma = sigma / whole
        s_1, s_2 = whole / slope, -(whole**2) * change / slope**3
        self._coefficients = np.empty((len(steps), 6, 1))
        quintic_coefficients(self._sigma, self._s[:, None], s_1[:, None], s_2[:, None], self._coefficients)

        along = (product / np.maximum(square, SMALLEST_LENGTH**2))[:, None]
        bend, turn = (q_ss - along * q_s) / acceleration, second - along * first
        # Least time per s that the limits of speed and centripetal acceleration allow.
        times = np.sqrt(square + np.linalg.norm(bend, axis=1))
        times = np.sqrt(1.0 + (times / max(float(self._integral(times)[-1]), SMALLEST_LENGTH)) ** 2)
        turns = np.linalg.norm(turn, axis=1) / np.sqrt(np.maximum(square, (SLOWEST_TURN * mean) ** 2))
        self._duration, self._turn = self._integral(times), self._integral(turns)

    def _integral(self, values: Array) -> Array:
        """Integral over s up to every node by the trapezoidal rule, (m,)."""
        return np.append(0.0, np.cumsum(0.5 * np.diff(self._s) * (values[1:] + values[:-1])))

    @property
    def grid(self) -> Array:
        """Grid of sigma for a speed profile, (m,) from 0 to 1; see `path_grid`."""
        return path_grid(self._sigma, self._duration, self._turn)

    @property
    def ends(self) -> Array:
        """Positions at both ends, (2, n)."""
        return self._path.q[[0, -1]]

    @property
    def seams(self) -> Array:
        """Sigma of the path's seams, which are samples, (j,)."""
        return self.sigma_of(self._path.seams)

    def sigma_of(self, s: Array) -> Array:
        """Sigma of samples of the path, (j,), from their s."""
        return np.asarray(np.interp(s, self._s, self._sigma))

    def s_of(self, sigma: Array) -> tuple[Array, Array, Array]:
        """The path's s and its two derivatives at sigma (m,), clipped to [0, 1], each (m,)."""
        s, first, second = (np.empty((len(sigma), 1)) for _ in range(3))
        quintics_at(self._sigma, self._coefficients, sigma, s, first, second)
        s[sigma >= 1.0] = 1.0
        return s[:, 0], first[:, 0], second[:, 0]

    def evaluate(self, sigma: Array) -> tuple[Array, Array, Array]:
        """Positions and their two derivatives at sigma (m,), clipped to [0, 1], each (m, n)."""
        s, s_1, s_2 = self.s_of(sigma)
        q, q_s, q_ss = self._path.evaluate(s)
        return q, q_s * s_1[:, None], q_ss * (s_1**2)[:, None] + q_s * s_2[:, None]
