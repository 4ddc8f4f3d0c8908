"""ReferenceFollowing: a tool that follows a stream of poses, or of twists if there are no poses."""

from typing import Final

from numpy.typing import ArrayLike

from robots_core.blocks.following.pose_following import FollowedStep, PoseFollowing
from robots_core.blocks.following.pose_reference import PoseReference, moved
from robots_core.pose import Pose
from robots_core.validation import Array

# Largest lead of the integrated pose over the robot while servoing.
LARGEST_LEAD: Final = (0.01, 0.02)  # m, rad


class ReferenceFollowing:
    """Follows a reference period by period, from samples at any rate.

    A twist that arrives beside poses is their velocity. Without poses it is integrated from the current pose
    of the tool (servoing).

    Args:
        following: Computes the steps.
        timeout: Without a sample for this long the reference is stale, s.
    """

    def __init__(self, following: PoseFollowing, *, timeout: float) -> None:
        self._following = following
        self._reference = PoseReference(timeout=timeout)
        self._integrated: Pose | None = None
        self.target: Pose | None = None
        """Reference pose of the tool at the end of the last period."""

    @property
    def timeout(self) -> float:
        """Age from which on a sample is stale, s."""
        return self._reference.timeout

    def put(self, pose: Pose, time: float) -> None:
        """Take a pose of the tool in the base frame that was valid at a time, s."""
        self._reference.put(pose, time)

    def put_twist(self, twist: ArrayLike, time: float) -> None:
        """Take a twist of the tool (6,), m/s and rad/s in the base frame, that was valid at a time, s.

        Raises:
            InvalidInputError: not six finite numbers.
        """
        self._reference.put_twist(twist, time)

    def forget(self) -> None:
        """Discard all samples."""
        self._reference = PoseReference(timeout=self._reference.timeout)
        self._integrated = None

    def place(self) -> None:
        """The robot was moved otherwise: twists are integrated from its current pose."""
        self._integrated = None

    def fresh(self, now: float) -> bool:
        """A pose or a twist came within the timeout."""
        return self._reference.fresh_pose(now) or self._reference.fresh_twist(now)

    def follow(self, now: float, q: Array, q_dot: Array) -> FollowedStep:
        """Motion of the next period, from a state of the robot (n,) each; a fresh pose or twist is required.

        Raises:
            UnreachablePoseError: the method finds no solution for `target`.
        """
        if self._reference.fresh_pose(now):
            self.target, twist = self._reference.at(now + self._following.dt, now)
            self._integrated = None
        else:
            twist = self._reference.twist(now)
            self.target = self._integrated = moved(
                self._integrated or self._following.pose(q), twist, self._following.dt
            )
        step = self._following.follow(self.target, twist, q, q_dot)
        if step.position_error > LARGEST_LEAD[0] or step.orientation_error > LARGEST_LEAD[1]:
            self._integrated = None
        return step
