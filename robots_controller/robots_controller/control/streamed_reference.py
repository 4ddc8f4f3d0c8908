"""StreamedReference: the controller follows a stream of single points."""

from dataclasses import dataclass

import numpy as np

from robots_core.blocks.following.axis_following import AxisFollowing
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, TrajectoryRefusedError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, read_only

# A point due later than this is meant as the goal of a motion, whose path there it does not give.
FARTHEST_DUE = 0.1  # s
# A point due earlier than this was delayed on its way, and its stream may have ended meanwhile.
OLDEST_DUE = 0.5  # s
# A late point is extrapolated with its acceleration for this long, then with constant speed.
ACCELERATION_HORIZON = 0.02  # s
# Rounding of a reference that was computed to lie on a limit.
TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class StreamPoint:
    """One point of a stream.

    Attributes:
        position: (n,), rad (m).
        velocity: (n,), rad/s.
        acceleration: (n,), rad/s^2, constant until the point is due.
        due: When the robot should be there, s, on the controller's clock.
    """

    position: Array
    velocity: Array
    acceleration: Array
    due: float

    def __post_init__(self) -> None:
        for name in ('position', 'velocity', 'acceleration'):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def check(self, axes: AxesData, now: float) -> None:
        """Check the point against the limits.

        Raises:
            JointLimitError: a position outside the limits.
            InvalidInputError: values not finite, too fast, due too late, or too long ago.
        """
        axes.check_position(self.position, 'point', tolerance=TOLERANCE)
        for name in ('velocity', 'acceleration'):
            values, limit = getattr(self, name), getattr(axes, name)
            inside = np.abs(values) <= limit * (1.0 + TOLERANCE)
            if not inside.all():
                worst = int(np.flatnonzero(~inside)[0])
                unit, bound = axes.unit(worst, name), limit[worst]
                raise InvalidInputError(
                    f'{name} of {axes.names[worst]} is {values[worst]:.6g} {unit}, allowed is '
                    f'[{-bound:.6g}, {bound:.6g}] {unit}',
                    joint=axes.names[worst],
                )
        if not self.due - now <= FARTHEST_DUE + TOLERANCE:
            raise InvalidInputError(
                f'a single point is a streamed reference, due at most {FARTHEST_DUE:g} s ahead, this one is '
                f'due in {self.due - now:.3g} s; a motion needs at least 2 points'
            )
        if now - self.due > OLDEST_DUE:
            raise InvalidInputError(
                f'a streamed reference may be late by {OLDEST_DUE:g} s, this one was due '
                f'{now - self.due:.3g} s ago: is the machine overloaded, are the clocks of sender and '
                'controller the same?'
            )


class StreamedReference:
    """Follows the newest point inside the limits, and brakes when no new one comes.

    Between the points the reference moves with the newest one's velocity and acceleration. Steps and
    jumps in it are followed as fast as the limits allow.

    Args:
        axes: The limits.
        period: Time between two references, s.
        timeout: Without a point for this long the stream is stale, s.
    """

    def __init__(self, axes: AxesData, *, period: float, timeout: float) -> None:
        self.following = AxisFollowing(axes, period)
        self.timeout = timeout
        self.id = ''
        self.start = 0.0
        self.failure: str | None = None
        self.stale = False
        """The failure is that no point came: a new one is followed at once, from wherever the robot is."""
        self._period = period
        self._point: StreamPoint | None = None
        self._received = self._refused_until = -np.inf

    @property
    def active(self) -> bool:
        """A stream is followed, or the robot brakes because it ended."""
        return self._point is not None

    def begin(self, id_: str, now: float) -> None:
        """Start a stream with the point that is put next."""
        self.id, self.start, self.failure, self.stale = id_, now, None, False

    def put(self, point: StreamPoint, now: float) -> None:
        """Follow another point from now on."""
        self._point, self._received = point, now
        if self.stale:
            self.failure, self.stale = None, False

    def refuse_stopped(self, now: float) -> None:
        """A stopped stream may begin again after a pause: its sender has to notice.

        Raises:
            TrajectoryRefusedError: it was stopped, and its points have not paused since.
        """
        stopped = self.failure is not None and not self.stale
        if stopped or now < self._refused_until:
            self._refused_until = now + self.timeout
            raise TrajectoryRefusedError(
                f'the stream was stopped; it may begin anew after {self.timeout:g} s of pause'
            )

    def stop(self, reason: str) -> None:
        """Brake for this reason, if a stream is followed; one that was stopped before keeps its own."""
        if self.active and (self.stale or not self.failure):
            self.failure, self.stale = reason, False

    def end(self, now: float, failure: str) -> MotionResult:
        """Drop the stream; returns its result, '' for success."""
        if failure and not self.stale:
            self._refused_until = now + self.timeout
        self._point, self.failure, self.stale = None, None, False
        message, details = failure or 'the stream ended', {'duration': round(now - self.start, 6)}
        return MotionResult(self.id, not failure, message, details)

    def step(self, now: float, reference: Array, speed: float) -> tuple[Array, bool]:
        """Next reference (3, n), and whether the stream is over and the robot stands.

        Args:
            now: Time, s.
            reference: The one before, (3, n).
            speed: Part of the velocity limits to use, 0..1; 0 holds the robot.
        """
        point = self._point
        assert point is not None
        if self.failure is None and now - self._received > self.timeout:
            rest = not point.velocity.any() and np.abs(point.position - reference[0]).max() <= TOLERANCE
            self.stale = True
            self.failure = '' if rest else f'no streamed point for {self.timeout:g} s: is its sender running?'
        q, q_dot = reference[0], reference[1]
        if self.failure is not None or speed == 0.0:
            over = self.failure is not None and not q_dot.any()
            return self.following.brake(q, q_dot), over
        t = now + self._period - point.due
        accelerated = min(max(t, -FARTHEST_DUE), ACCELERATION_HORIZON)
        velocity = point.velocity + accelerated * point.acceleration
        position = point.position + accelerated * (point.velocity + 0.5 * accelerated * point.acceleration)
        position += (t - accelerated) * velocity
        return self.following.step(q, q_dot, position, velocity, speed), False
