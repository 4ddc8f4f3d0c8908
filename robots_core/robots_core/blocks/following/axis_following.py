"""AxisFollowing: every axis follows a moving reference inside its limits, able to brake at any time."""

import numpy as np

from robots_core.blocks.inverse_kinematics.viability import fastest_stoppable, velocity_interval
from robots_core.errors import InvalidInputError
from robots_core.kernels.compiled import compiled
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, positive

GAIN = 0.5  # fraction of the position error removed per period
# Fraction of the deceleration used for approaching the reference; the rest is for a moving reference.
APPROACH_SHARE = 0.8
# Errors below this are rounding; removing them would never end.
ROUNDING = 1e-14  # rad (m)


class AxisFollowing:
    """Follows joint references, axis by axis, with constant acceleration in each period.

    A reference that keeps the limits itself is followed exactly; one that jumps is approached as fast as the
    axis can stop again when it arrives. The state stays viable (see `viability`), whatever the reference is.

    An instance keeps scratch memory: use one per thread.

    Args:
        axes: The limits.
        dt: Period, s.
        deceleration: For braking, (n,), rad/s^2; the acceleration limits by default.

    Raises:
        InvalidInputError: a period or deceleration that is not positive, or one above the acceleration limit.
    """

    def __init__(self, axes: AxesData, dt: float, *, deceleration: Array | None = None) -> None:
        self.dt = positive(dt, 'dt', 's')
        braking = axes.acceleration if deceleration is None else np.asarray(deceleration)
        if not ((braking > 0.0) & (braking <= axes.acceleration)).all():
            raise InvalidInputError(
                f'deceleration {braking} must be above 0 and at most the acceleration limits'
            )
        self._limits = np.array([axes.lower, axes.upper, axes.velocity, axes.acceleration, braking])
        self._still = np.zeros(axes.num_axes)
        self._now = np.empty((4, axes.num_axes))
        # Compiled code is loaded here and not in the first step of a real-time loop.
        inside = np.clip(self._still, axes.lower, axes.upper)
        self.step(inside, self._still, inside, self._still)
        self.brake(inside, self._still)

    def step(
        self, q: Array, q_dot: Array, q_reference: Array, q_dot_reference: Array, speed: float = 1.0
    ) -> Array:
        """State after the next period, (3, n): positions, velocities, and accelerations during it.

        Args:
            q: Positions now, (n,), rad (m); not checked.
            q_dot: Velocities now, (n,), rad/s.
            q_reference: Reference positions at the end of the period, (n,).
            q_dot_reference: Reference velocities then, (n,).
            speed: Part of the velocity limits to use, 0..1.
        """
        # Compiled code is specialised for one memory layout; another would take seconds to compile.
        now, state = self._now, np.empty((3, q.size))
        now[0], now[1], now[2], now[3] = q, q_dot, q_reference, q_dot_reference
        _follow(now, self._limits, speed, self.dt, state)
        return state

    def brake(self, q: Array, q_dot: Array) -> Array:
        """State after a period of braking, (3, n), as `step`; each axis stops as early as possible."""
        deceleration = self._limits[4]
        change = np.clip(-q_dot, -deceleration * self.dt, deceleration * self.dt)
        # Subtracting a speed from itself leaves zero exactly, so that braking ends.
        end = q_dot + change
        state: Array = np.array([q + 0.5 * self.dt * (q_dot + end), end, change / self.dt])
        return state


@compiled()
def _follow(now: Array, limits: Array, speed: float, dt: float, state: Array) -> None:
    """`AxisFollowing.step`, from positions and velocities, and their references, (4, n)."""
    q, q_dot, q_reference, q_dot_reference = now[0], now[1], now[2], now[3]
    n = q.size
    low, high, slower = np.empty(n), np.empty(n), limits.copy()
    for i in range(n):
        slower[2, i] = speed * limits[2, i]
    velocity_interval(q, q_dot, slower, dt, low, high)
    for i in range(n):
        # The error that remains if the axis moves like the reference from now on.
        error = q_reference[i] - q[i] - 0.5 * dt * (q_dot[i] + q_dot_reference[i])
        towards = 0.0
        if abs(error) > ROUNDING:
            towards = min(
                GAIN / dt * abs(error), fastest_stoppable(abs(error), APPROACH_SHARE * limits[4, i], dt)
            )
        wanted = q_dot_reference[i] + (towards if error > 0.0 else -towards)
        end = min(max(wanted, low[i]), high[i])
        state[0, i] = q[i] + 0.5 * dt * (q_dot[i] + end)
        state[1, i] = end
        state[2, i] = (end - q_dot[i]) / dt
