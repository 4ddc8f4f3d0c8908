"""CartesianGenerator: what all motions along a path of the tool have in common."""

from __future__ import annotations

from functools import cached_property
from typing import ClassVar, Literal

from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.errors import InvalidInputError, PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import LIMIT_MARGIN, TrajectoryGenerator
from robots_planning.trajectory_generators.cartesian_path import CartesianPath
from robots_planning.trajectory_generators.dynamic_programming_timing import DynamicProgrammingTiming
from robots_planning.trajectory_generators.joint_path import JointPath
from robots_planning.trajectory_generators.path_inverse_kinematics import PathInverseKinematics
from robots_planning.trajectory_generators.path_timing import PathTiming, ToolLimits
from robots_planning.trajectory_generators.two_pass_timing import TwoPassTiming

Planner = Literal['limited', 'dynamic_programming']
PLANNERS = ('limited', 'dynamic_programming')


class CartesianGenerator(TrajectoryGenerator):
    """The tool centre point follows a path of poses, as fast as the limits of axes and tool allow.

    By default, a forward and a backward pass over the path speed hold the limits on a grid; the time law is
    then smoothed, so that acceleration is continuous, and slowed down where it would break a limit. Near a
    singularity the motion becomes slow. Axis torque is not limited.

    Args:
        robot: The robot.
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration and jerk limits to use, in (0, 1].
        cartesian_speed: Highest speed of the tool, m/s.
        cartesian_acceleration: Highest acceleration of the tool, m/s^2; on a curve its magnitude, with the
            centripetal part.
        rotation_speed: Highest angular speed of the tool, rad/s.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2.
        jerk_limited: Keep the axes' jerk limits too.
        cartesian_jerk: Highest jerk of the tool, m/s^3, kept if `jerk_limited`; none by default. For planner
            'limited' only.
        smoothing: Longest smoothing of acceleration without jerk limits, s; at most a hundredth of the
            duration is used, and the motion is longer by that much.
        tool: Pose of the tool centre point in tool0; poses commanded are its poses. tool0 itself by default.
        planner: 'limited' for the two passes, 'dynamic_programming' for the fastest motion, which keeps the
            axes' torque limits too.

    Raises:
        InvalidInputError: a fraction outside (0, 1], or another option that is not above 0.
    """

    accepts_joints: ClassVar[bool] = False

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        speed_fraction: float = 1.0,
        acceleration_fraction: float = 1.0,
        cartesian_speed: float = 0.5,
        cartesian_acceleration: float = 2.0,
        rotation_speed: float = 1.5,
        rotation_acceleration: float = 6.0,
        jerk_limited: bool = False,
        cartesian_jerk: float | None = None,
        smoothing: float = 0.008,
        tool: Pose | None = None,
        planner: Planner = 'limited',
    ) -> None:
        super().__init__(robot, speed_fraction=speed_fraction, acceleration_fraction=acceleration_fraction)
        self.tool = tool
        self.path_kinematics = PathInverseKinematics(robot, tool)
        limits = ToolLimits(
            cartesian_speed, cartesian_acceleration, rotation_speed, rotation_acceleration, cartesian_jerk
        )
        if planner not in PLANNERS:
            raise InvalidInputError(f'planner = {planner!r} must be one of {", ".join(map(repr, PLANNERS))}')
        if planner == 'dynamic_programming' and cartesian_jerk is not None:
            raise InvalidInputError(
                f"cartesian_jerk = {cartesian_jerk!r} needs planner 'limited'; 'dynamic_programming' keeps "
                'no jerk limits but those of the axes'
            )
        self.timing: PathTiming
        jerk = self.jerk if jerk_limited else None
        if planner == 'limited':
            self.timing = TwoPassTiming(self.velocity, self.acceleration, jerk, limits, smoothing=smoothing)
        else:
            effort = robot.axes_data.effort * (1.0 - LIMIT_MARGIN)
            self.timing = DynamicProgrammingTiming(
                robot, self.velocity, self.acceleration, effort, limits, jerk=jerk
            )

    @cached_property
    def inverse_kinematics(self) -> DampedLeastSquares:
        """Of the tool centre point; made when it is first needed."""
        return DampedLeastSquares(self.robot, tool=self.tool)

    def plan_path(self, path: CartesianPath, start: Array) -> Trajectory:
        """The motion along a path that begins at joint positions `start`, (n,).

        Raises:
            PlanningError: the path leaves the axis limits or the reach, or crosses a singularity; says where.
            UnreachablePoseError: the end of the path cannot be reached at all.
        """
        return self.timing.trajectory(self.follow(path, start), path)

    def follow(self, path: CartesianPath, start: Array) -> JointPath:
        """The joint path of a path; raises as `plan_path`."""
        # A pose that no posture reaches is told as such, before the place where the path fails.
        try:
            return self.path_kinematics.follow(path, start)
        except PlanningError:
            self.reach(path.end, start)
            raise
