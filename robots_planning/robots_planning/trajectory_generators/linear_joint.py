"""LinearJoint and LinearJointAxes: point-to-point, all axes together or every axis as fast as it can."""

from functools import cached_property

import numpy as np
from ruckig import Synchronization

from robots_core.validation import Array
from robots_planning.timing.state_to_rest_profile import NoProfileError, StateToRestProfile
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN

STILL = 1e-200  # of the longest displacement; of a smaller one no limit would be a finite number


class LinearJoint(JointSpaceGenerator):
    """All axes start and stop together on a straight joint-space line, as fast as the slowest axis can.

    The line is q = q_start + s (q_target - q_start). Velocity, acceleration and jerk limits of every axis
    bound those of s, whose time-optimal motion from rest to rest is Ruckig's.

    From a moving start there is no such line. Then all axes arrive together, in the shortest time possible
    for all of them, each on a profile of its own (Ruckig's time synchronisation; Berscheid and Kroeger 2021).
    An axis that would leave its position limits in doing so brakes independently and arrives earlier.
    """

    synchronization = Synchronization.Time

    def _from_rest(self, start: Array, target: Array) -> tuple[Array, Array, Array, Array]:
        # The path coordinate is the longest displacement, so that short moves keep their precision.
        direction = target - start
        longest = max(map(abs, direction.tolist()))
        direction /= longest
        limits = np.minimum.reduce(self._limits / np.maximum(np.abs(direction), STILL), axis=1, keepdims=True)
        allowed = limits / (1.0 - LIMIT_MARGIN)
        try:
            points = self._line.plan(np.zeros((3, 1)), np.array([longest]), limits, allowed, allowed)
        except NoProfileError:
            raise NoProfileError(int(np.argmax(np.abs(direction)))) from None
        time, s, s_dot, s_ddot = points
        q = start + s * direction
        q[-1] = target
        return time, q, s_dot * direction, s_ddot * direction

    @cached_property
    def _line(self) -> StateToRestProfile:
        return StateToRestProfile(np.array([[-np.inf], [np.inf]]), self.synchronization, self.shortest)


class LinearJointAxes(JointSpaceGenerator):
    """Every axis runs its own time-optimal jerk-limited profile; axes that move less arrive sooner.

    From rest or from motion, each axis comes to rest at its target as soon as its limits allow (Ruckig;
    Berscheid and Kroeger 2021).
    """

    synchronization = Synchronization.No
