"""LinearCartesianLimited and LinearCartesianDynamicProgramming: a straight line of the tool."""

from typing import Any, ClassVar

from robots_core.blocks.inverse_kinematics.hold import POSE, POSITION
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.cartesian_path import COINCIDENT_ANGLE, COINCIDENT_DISTANCE
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.cartesian_generator import TOOL_LIMITS, CartesianGenerator
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


class LinearCartesianDynamicProgramming(LinearCartesianLimited):
    """The tool moves on a straight line and turns about one axis, in the shortest time.

    Velocity, acceleration and torque limits of the axes hold everywhere. The speed along the line is found by
    dynamic programming over path and speed (Shin and McKay 1986; Pham and Pham 2018); jumps of acceleration
    become short ramps. Close to a singularity the motion slows down; in one, the tool may stand still while
    the axes turn to a configuration in which the line can be continued. Robots with more than six axes use
    their self-motion (see `ConfigurationGraph`).

    Args:
        robot: The robot.
        options: See `CartesianGenerator`; by default the tool has no limits of its own.

    Raises:
        InvalidInputError: an option that is not valid.
    """

    keeps_torque = True

    def __init__(self, robot: BaseRobotModel, **options: Any) -> None:
        unlimited: dict[str, Any] = dict.fromkeys(TOOL_LIMITS)
        super().__init__(robot, **unlimited | options)
