"""CartesianGenerator: motions along a path of the tool, timed by two passes or by dynamic programming."""

from typing import Any, Literal

import numpy as np

from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import positive
from robots_planning.path_kinematics.configuration_graph import ConfigurationGraph
from robots_planning.timing.dynamic_programming_timing import DynamicProgrammingTiming
from robots_planning.timing.time_optimal import TimeOptimalTiming
from robots_planning.timing.two_pass_timing import TwoPassTiming
from robots_planning.trajectory_generators.base import LIMIT_MARGIN
from robots_planning.trajectory_generators.path_generator import PathGenerator

Planner = Literal['limited', 'dynamic_programming']
PLANNERS = ('limited', 'dynamic_programming')


class CartesianGenerator(PathGenerator):
    """The tool centre point follows a path of poses, as fast as the limits of axes and tool allow.

    By default, a forward and a backward pass over the path speed hold the limits on a grid; the time law is
    then smoothed, so that acceleration is continuous, and slowed down where it would break a limit. Near a
    singularity the motion becomes slow. Axis torque is not limited. An arm that holds less than a pose turns
    the tool as it must; its motions are timed by dynamic programming, without `smoothing`.

    Args:
        robot: The robot.
        cartesian_speed: Highest speed of the tool, m/s; as for the other limits of the tool, None for none.
        cartesian_acceleration: Highest acceleration of the tool, m/s^2; on a curve its magnitude, with the
            centripetal part, or by 'dynamic_programming' either part of it.
        rotation_speed: Highest angular speed of the tool, rad/s.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2.
        jerk_limited: Keep the axes' jerk limits too.
        cartesian_jerk: Highest jerk of the tool, m/s^3, kept if `jerk_limited`; none by default. For planner
            'limited' only.
        smoothing: Longest smoothing of acceleration without jerk limits, s; at most a two-hundredth of the
            duration is used, and the motion is longer by that much.
        planner: 'limited' for the two passes, 'dynamic_programming' for the fastest motion, which keeps the
            axes' torque limits too and chooses among configurations (see `ConfigurationGraph`).
        torque: Keep the axes' torque limits. For planner 'dynamic_programming' only.
        options: See `TrajectoryGenerator`.

    Raises:
        InvalidInputError: an option that is not valid.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        cartesian_speed: float | None = 0.5,
        cartesian_acceleration: float | None = 2.0,
        rotation_speed: float | None = 1.5,
        rotation_acceleration: float | None = 6.0,
        jerk_limited: bool = False,
        cartesian_jerk: float | None = None,
        smoothing: float = 0.008,
        planner: Planner = 'limited',
        torque: bool = True,
        **options: Any,
    ) -> None:
        super().__init__(robot, **options)
        *motion, tool_jerk = (
            np.inf if value is None else positive(value, name, unit)
            for name, value, unit in (
                ('cartesian_speed', cartesian_speed, 'm/s'),
                ('cartesian_acceleration', cartesian_acceleration, 'm/s^2'),
                ('rotation_speed', rotation_speed, 'rad/s'),
                ('rotation_acceleration', rotation_acceleration, 'rad/s^2'),
                ('cartesian_jerk', cartesian_jerk, 'm/s^3'),
            )
        )
        tool = np.array(motion)
        if planner not in PLANNERS:
            raise InvalidInputError(f'planner = {planner!r} must be one of {", ".join(map(repr, PLANNERS))}')
        fastest = planner == 'dynamic_programming'
        if fastest and cartesian_jerk is not None:
            raise InvalidInputError(
                f"cartesian_jerk = {cartesian_jerk!r} needs planner 'limited'; 'dynamic_programming' keeps "
                'no jerk limits but those of the axes'
            )
        self.keeps_torque = fastest and torque
        oriented = self.hold == POSE
        jerk = self.jerk if jerk_limited else None
        if oriented and not fastest:
            self.timing = TwoPassTiming(
                self.velocity, self.acceleration, jerk, tool, tool_jerk=tool_jerk, smoothing=smoothing
            )
            return
        if oriented:
            self.configuration_graph = ConfigurationGraph(robot, self.path_kinematics, self.tool)
        effort = robot.axes_data.effort * (1.0 - LIMIT_MARGIN) if self.keeps_torque else None
        self.timing = DynamicProgrammingTiming(
            TimeOptimalTiming(robot, self.velocity, self.acceleration, effort, jerk=jerk),
            robot,
            tool,
            turning_tool=None if oriented else self.tool_position,
        )
