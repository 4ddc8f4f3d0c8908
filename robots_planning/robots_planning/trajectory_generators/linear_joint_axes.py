"""LinearJointAxes: point-to-point, every axis as fast as it can."""

from ruckig import Synchronization

from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator


class LinearJointAxes(JointSpaceGenerator):
    """Every axis runs its own time-optimal jerk-limited profile; axes that move less arrive sooner.

    From rest or from motion, each axis comes to rest at its target as soon as its limits allow (Ruckig;
    Berscheid and Kroeger 2021).
    """

    synchronization = Synchronization.No
