"""PoseReference: a moving reference pose from samples at any rate."""

import numpy as np
from numpy.typing import ArrayLike

from robots_core.orientation import rotation_from_vector
from robots_core.pose import Pose
from robots_core.validation import Array, bounded_vector, positive

# A sample is extrapolated for this many sample intervals, so that a late one does not stop the robot.
HORIZON_INTERVALS = 1.5
FASTEST = 1000.0  # m/s, rad/s
JUMP = (3.0, 6.0)  # m/s, rad/s between two samples
NO_TWIST = np.zeros(6)


class PoseReference:
    """Pose and twist of a reference, at its samples and extrapolated shortly beyond.

    The twist is that of the newest sample where it is given, else the difference of the last two. A
    difference above `JUMP` is a jump, after which the twist is 0.

    Args:
        timeout: Without a sample for this long the reference is stale, s.
    """

    def __init__(self, *, timeout: float) -> None:
        self.timeout = positive(timeout, 'timeout', 's')
        self._pose: Pose | None = None
        self._time = self._twist_time = -np.inf
        self._interval = 0.0
        self._twist: Array = NO_TWIST
        self._given: Array = NO_TWIST

    def put(self, pose: Pose, time: float) -> None:
        """Take a sample of the pose at a time, s; one that is not newer than the last is a new reference."""
        interval = time - self._time
        known = self._pose is not None and 0.0 < interval <= self.timeout
        twist = self._pose.error_to(pose) / interval if known and self._pose is not None else NO_TWIST
        jump = np.linalg.norm(twist[:3]) > JUMP[0] or np.linalg.norm(twist[3:]) > JUMP[1]
        self._twist = NO_TWIST if jump else twist
        self._interval = interval if known else 0.0
        self._pose, self._time = pose, time

    def put_twist(self, twist: ArrayLike, time: float) -> None:
        """Take a sample of the twist, (6,): velocity (m/s), angular velocity (rad/s), at a time, s.

        Raises:
            InvalidInputError: not six numbers up to `FASTEST`.
        """
        self._given, self._twist_time = bounded_vector(twist, 6, 'twist', FASTEST, 'm/s, rad/s'), time

    def fresh_pose(self, now: float) -> bool:
        """Whether a pose arrived within the timeout."""
        return now - self._time <= self.timeout

    def fresh_twist(self, now: float) -> bool:
        """Whether a twist arrived within the timeout."""
        return now - self._twist_time <= self.timeout

    def twist(self, now: float) -> Array:
        """The twist that is given, or the difference of the last two poses, (6,)."""
        return self._given if self.fresh_twist(now) else self._twist

    def at(self, time: float, now: float) -> tuple[Pose, Array]:
        """Pose and twist (6,) at a time near now, s; a pose must have arrived before."""
        assert self._pose is not None
        twist = self.twist(now)
        horizon = self.timeout if self.fresh_twist(now) else HORIZON_INTERVALS * self._interval
        ahead = time - self._time
        if ahead > horizon:
            return moved(self._pose, twist, horizon), NO_TWIST
        return moved(self._pose, twist, ahead), twist


def moved(pose: Pose, twist: Array, time: float) -> Pose:
    """A pose after moving with a constant twist (6,), base frame, for a time, s."""
    return Pose(pose.r + time * twist[:3], rotation_from_vector(time * twist[3:]) @ pose.T)
