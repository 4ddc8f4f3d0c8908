"""PathFollowing: follows the path of a motion, at the planned speed or below it."""

import numpy as np

from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.interpolator import Interpolator
from robots_controller.control.span import Span
from robots_controller.control.speed.path_speed import PathSpeed
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

LATE = 1e-3  # of the path speed; the rounding of one that follows its cap is less


class PathFollowing:
    """Samples a path as far as its speed permits, and averages the samples."""

    def __init__(self, axes: AxesData, settings: ControllerSettings) -> None:
        self._axes, self._period = axes, settings.period
        window = max(1, round(settings.smoothing_time / settings.period))
        self._average = Interpolator(axes.num_axes, window)
        self._speed = PathSpeed(axes.acceleration, period=settings.period, ramp_time=settings.ramp_time)
        self._sample = np.zeros((3, axes.num_axes))
        self._unchanged = 0
        self.fast_stop = False
        """Change the speed as fast as the limits permit, whatever the ramp time."""

    @property
    def standing(self) -> bool:
        """The reference has come to rest: all samples of the average are the same."""
        return self._unchanged >= self._average.window

    def stand_at(self, position: Array) -> Array:
        """Stand at joint positions (n,); returns the reference, (3, n)."""
        self._sample = np.zeros((3, self._axes.num_axes))
        self._sample[0] = position
        self._average.reset(position)
        return self._sample.copy()

    def begin(self, motion: FollowedMotion, speed: float) -> None:
        """Follow a motion that starts where the reference stands, at a speed of 0..1."""
        self._unchanged = 0
        self._speed.reset(self._capped(motion, speed))

    def step(self, motion: FollowedMotion, speed: float) -> Array:
        """Follow a motion for one period, its speed going to `speed`, 0..1.

        Returns:
            The reference, (3, n): position, velocity, acceleration.
        """
        # A border that has just been closed may be nearer than the ramp takes.
        late = motion.held is not None and self._speed.speed > motion.held.here(motion.path_time) + LATE
        self._speed.fast_stop = self.fast_stop or late
        moved = self._advance(motion, self._capped(motion, speed))
        self._unchanged = 0 if moved else self._unchanged + 1
        return self._average.push(self._sample)

    def ahead(self, motion: FollowedMotion, speed: float, periods: int) -> Span:
        """What `step` will return in the next periods, at most so many, while the speed stays even."""
        if motion.cap is not None or motion.held is not None or not self._speed.even(speed):
            return Span.standing(self._sample, 0)
        path_times = self._speed.ahead(motion.path_time, periods)
        progress = path_times / motion.trajectory.duration
        periods = min(int(path_times.searchsorted(motion.join_time)), int(progress.searchsorted(1.0)))
        if periods == 0:
            return Span.standing(self._sample, 0)
        samples = motion.samples(path_times[:periods])
        speed = self._speed.end_speed
        samples[:, 1] *= speed
        samples[:, 2] *= speed**2
        return Span(self._average.ahead(samples), progress[:periods], path_times[:periods], samples)

    def pass_over(self, motion: FollowedMotion, span: Span) -> None:
        """Periods of a span of this motion have passed."""
        motion.path_time = float(span.path_times[-1])
        self._speed.keep()
        self._average.pass_over(span.samples)
        self._sample = span.samples[-1].copy()
        self._unchanged = 0

    def _capped(self, motion: FollowedMotion, speed: float) -> float:
        cap = motion.held or motion.cap
        return speed if cap is None else min(speed, cap.at(motion.path_time, self._period))

    def _advance(self, motion: FollowedMotion, target: float) -> bool:
        """Move along the path for one period; False when the reference stands."""
        law = self._speed
        before = motion.path_time
        motion.path_time = law.step(target, before, motion)
        if motion.path_time == before or before >= motion.trajectory.duration:
            self._sample[1:] = 0.0
            return False
        path = motion.sample(motion.path_time)
        speed = law.end_speed
        self._sample[0] = path[0]
        self._sample[1] = path[1] * speed
        self._sample[2] = path[2] * speed**2
        if law.rate != 0.0:
            # The derivative at this instant may lie past its mean over the period; only that mean moves
            # the robot, and the path speed keeps it inside the limits.
            limit = self._axes.acceleration
            self._sample[2] = np.clip(self._sample[2] + path[1] * law.rate, -limit, limit)
        return True
