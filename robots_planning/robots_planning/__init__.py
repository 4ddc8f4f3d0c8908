"""Path planning: trajectory generators, verification, and the switch between them."""

from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited
from robots_planning.trajectory_generators.linear_joint import LinearJoint

__all__ = ['LinearCartesianLimited', 'LinearJoint', 'Trajectory']
