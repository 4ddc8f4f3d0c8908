"""ReferenceFollowing: a tool that follows a stream of poses, or of twists where no poses come."""

from __future__ import annotations

from typing import Final

from numpy.typing import ArrayLike

from robots_core.blocks.following.pose_following import FollowedStep, PoseFollowing
from robots_core.blocks.following.pose_reference import PoseReference, moved
from robots_core.pose import Pose
from robots_core.validation import Array

# While servoing, the pose that the twist leads to runs ahead of the robot by no more.
LEASH: Final = (0.01, 0.02)  # m, rad


class ReferenceFollowing:
    """Follows a reference period by period, from samples at any rate.

    Beside fresh poses a twist says how they move. Alone it is followed itself (servoing): it leads the tool
    on from where it is.

    Args:
        following: Makes the steps.
        timeout: Without a sample for this long the reference is stale, s.
    """

    def __init__(self, following: PoseFollowing, *, timeout: float) -> None:
        self._following = following
        self._reference = PoseReference(timeout=timeout)
        self._led: Pose | None = None
        self.target: Pose | None = None
        """Where the tool shall be at the end of the last period."""

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
        """Forget all samples."""
        self._reference = PoseReference(timeout=self._reference.timeout)
        self._led = None

    def place(self) -> None:
        """The robot is somewhere else than the last step has led it: twists lead it on from there."""
        self._led = None

    def fresh(self, now: float) -> bool:
        """A pose or a twist came within the timeout."""
        return self._reference.fresh_pose(now) or self._reference.fresh_twist(now)

    def follow(self, now: float, q: Array, q_dot: Array) -> FollowedStep:
        """Motion of the next period, from a state of the robot (n,) each; something fresh must be there.

        Raises:
            UnreachablePoseError: the method finds no posture for `target`.
        """
        if self._reference.fresh_pose(now):
            self.target, twist = self._reference.at(now + self._following.dt, now)
            self._led = None
        else:
            twist = self._reference.twist(now)
            self.target = self._led = moved(self._led or self._following.pose(q), twist, self._following.dt)
        step = self._following.follow(self.target, twist, q, q_dot)
        if step.position_error > LEASH[0] or step.orientation_error > LEASH[1]:
            self._led = None
        return step
