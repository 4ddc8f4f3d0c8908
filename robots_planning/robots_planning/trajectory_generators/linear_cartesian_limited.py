"""LinearCartesianLimited: a straight line of the tool inside the limits of velocity and acceleration."""

from typing import ClassVar

from robots_core.blocks.inverse_kinematics.hold import POSE, POSITION
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.cartesian_path import COINCIDENT_ANGLE, COINCIDENT_DISTANCE
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.cartesian_generator import CartesianGenerator
from robots_planning.trajectory_generators.trajectory_generator import Target, ToolGeometry, rest_trajectory


class LinearCartesianLimited(CartesianGenerator):
    """The tool moves on a straight line and turns about one axis. Options: see `CartesianGenerator`."""

    kinds: ClassVar[tuple[str, ...]] = ('line',)

    def path(self, start: Pose, target: Pose) -> CartesianLine:
        """The line between two poses."""
        return CartesianLine(start, target)

    def geometry(self, start: Pose, target: Target) -> ToolGeometry:
        """See `TrajectoryGenerator.geometry`."""
        assert isinstance(target, Pose)
        return {'line': (start, target), 'oriented': self.hold == POSE}

    def plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_pose`."""
        line = self.path(self.path_kinematics.pose(start), target)
        turns = self.hold != POSITION and line.angle >= COINCIDENT_ANGLE
        if line.length < COINCIDENT_DISTANCE and not turns:
            return rest_trajectory(start, start)
        return self.plan_path(line, start)
