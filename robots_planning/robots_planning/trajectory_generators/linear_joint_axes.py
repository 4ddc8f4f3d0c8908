"""LinearJointAxes: point-to-point, every axis as fast as it can."""

from ruckig import Synchronization

from robots_core.validation import Array
from robots_planning.timing.rest_to_rest_profile import each_axis
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator


class LinearJointAxes(JointSpaceGenerator):
    """Every axis runs its own time-optimal jerk-limited profile; axes that move less arrive sooner.

    From motion, too, each axis comes to rest at its target as soon as its limits allow (Ruckig; Berscheid and
    Kroeger 2021). Where switches of jerk of two axes would be closer together than `shortest`, all are moved
    to whole multiples of it, which delays an axis by at most three of them.
    """

    synchronization = Synchronization.No

    def _points(
        self, start: Array, target: Array, limits: Array, shortest: int
    ) -> tuple[Array, Array, Array, Array]:
        points = each_axis(start, target, limits, 1, shortest)
        return points if points[0].size else each_axis(start, target, limits, shortest, shortest)
