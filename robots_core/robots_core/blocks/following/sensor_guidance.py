"""SensorGuidance: when a sensor guides the robot, from where, and how that ends."""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.following.following_methods import LARGEST_DEVIATION
from robots_core.blocks.following.realtime_movement import MovementState, RealtimeMovement, RealtimeStep
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array

# How often the controller's reference is compared with the one sent; on messages a comparison is expensive.
CONTROLLER_RATE: Final = 25.0  # Hz


class SensorGuidance:
    """A `RealtimeMovement` from the controller's reference on, for as long as the robot is handed over.

    The stream begins with the first fresh sample, and starts again from the controller's reference if the
    controller does not follow. Without fresh samples, or when the robot is taken back, it brakes and ends.

    Args:
        movement: Follows the samples.
        reference: The controller's reference (2 or more, n): positions and velocities; None for none yet.
        refused: Gets the topic and the error of what cannot be followed.
        largest_deviation: The controller's reference may be this far from the one sent, rad (m).
    """

    def __init__(
        self,
        movement: RealtimeMovement,
        *,
        reference: Callable[[], Array | None],
        refused: Callable[[str, RobotsError], None],
        largest_deviation: float = LARGEST_DEVIATION,
    ) -> None:
        self._movement, self._largest_deviation = movement, largest_deviation
        self._reference, self._refused = reference, refused
        self._every = max(1, round(1.0 / (movement.dt * CONTROLLER_RATE)))
        self._cycle = 0  # of the stream
        self._handed_over = False
        self._last: RealtimeStep | None = None
        self.streaming = False
        """The robot is guided, or brakes from it."""
        self.ended = ''
        """Why the stream has ended; '' if that was wanted."""

    def hand_over(self, *, handed_over: bool) -> None:
        """Let samples guide the robot; otherwise it is braked, and they are ignored."""
        if self._handed_over and not handed_over:
            self._movement.release()
            self.ended = ''
        self._handed_over = handed_over

    def put(self, pose: Pose, time: float) -> None:
        """Take a reference pose of the tool in the base frame that was valid at a time, s."""
        if self._handed_over:
            self._movement.put(pose, time)

    def put_twist(self, twist: ArrayLike, time: float) -> None:
        """Take how the reference moves, see `RealtimeMovement.put_twist`."""
        if self._handed_over:
            self._movement.put_twist(twist, time)

    def idle(self, now: float) -> bool:
        """As long as nothing is put, all steps from now on, s, do nothing."""
        return not self.streaming and not self._movement.fresh(now)

    def step(self, now: float) -> RealtimeStep | None:
        """Motion of the next period, now in s; None for a robot that is not guided."""
        if not self.streaming:
            if not self._movement.fresh(now) or not self._start():
                return None
            self._cycle = 0
        else:
            self._cycle += 1
            if self._cycle % self._every == 0:
                self._check_controller()
        step = self._movement.step(now)
        if step.error is not None:
            self._refused('reference_pose', step.error)
        self._last = step
        # The last point has no acceleration that the controller could extrapolate.
        self.streaming = step.state is not MovementState.IDLE
        if not self.streaming and self._handed_over:
            self.ended = f'no reference for {self._movement.timeout:g} s, the robot stands'
        return step

    def _start(self) -> bool:
        reference = self._reference()
        if reference is None:
            return False
        self._movement.place(reference[0], reference[1])
        self.ended = ''
        return True

    def _check_controller(self) -> None:
        reference = self._reference()
        if reference is None or self._last is None:
            return
        if np.abs(reference[0] - self._last.q).max() > self._largest_deviation:
            self._movement.place(reference[0], reference[1])
            self._refused('joint_reference', InvalidInputError('the controller does not follow'))
