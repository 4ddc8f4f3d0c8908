"""LinearCartesianLimited: point-to-point on a straight line of the tool, by the two-pass algorithm."""

from __future__ import annotations

from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.cartesian_path import COINCIDENT_ANGLE, COINCIDENT_DISTANCE
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import rest_trajectory
from robots_planning.trajectory_generators.cartesian_generator import CartesianGenerator


class LinearCartesianLimited(CartesianGenerator):
    """The tool moves on a straight line and turns about one axis. Options: see `CartesianGenerator`."""

    def _plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        line = CartesianLine(self.path_kinematics.pose(start), target)
        if line.length < COINCIDENT_DISTANCE and line.angle < COINCIDENT_ANGLE:
            return rest_trajectory(start, start)
        return self.plan_path(line, start)
