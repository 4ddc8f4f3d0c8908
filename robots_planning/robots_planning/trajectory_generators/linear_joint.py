"""LinearJoint: point-to-point on a straight line in joint space."""

from ruckig import Synchronization

from robots_core.validation import Array
from robots_planning.timing.rest_to_rest_profile import line
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator


class LinearJoint(JointSpaceGenerator):
    """All axes start and stop together on a straight joint-space line, as fast as the slowest axis can.

    The line is q = q_start + s (q_target - q_start). Velocity, acceleration and jerk limits of every axis
    bound those of s, whose time-optimal motion from rest to rest has a closed form (`rest_to_rest_profile`).

    From a moving start there is no such line. Then all axes arrive together, in the shortest time possible
    for all of them, each on a profile of its own (Ruckig's time synchronisation; Berscheid and Kroeger 2021).
    An axis that would leave its position limits in doing so brakes independently and arrives earlier.
    """

    synchronization = Synchronization.Time

    def _points(
        self, start: Array, target: Array, limits: Array, shortest: int
    ) -> tuple[Array, Array, Array, Array]:
        return line(start, target, limits, 1, shortest)
