"""DynamicProgrammingTiming: time-optimal motion along a path of the tool."""

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import TimeOptimalTiming, ToolLimits
from robots_planning.timing.tool_travel import tool_derivatives, travel
from robots_planning.trajectory import Trajectory


class DynamicProgrammingTiming:
    """The fastest motion along a path that keeps the limits of axes, torques and tool.

    The tool's tangential and normal accelerations are limited separately.

    Args:
        robot: The robot.
        velocity: Of the axes, (n,), rad/s (m/s).
        acceleration: rad/s^2 (m/s^2).
        effort: Torques, N m (N); None for no limits.
        tool_velocity: Of the tool, (2,), m/s and rad/s; infinite for no limit.
        tool_acceleration: (2,), m/s^2 and rad/s^2; infinite for no limit.
        jerk: Of the axes, rad/s^3 (m/s^3); None for no limits.
        turning_tool: Position in tool0, (3,) m, of a tool that turns as the arm must, whose speeds are those
            of the axes' path; None for a tool that has the orientations of its own path.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        velocity: Array,
        acceleration: Array,
        effort: Array | None,
        *,
        tool_velocity: Array,
        tool_acceleration: Array,
        jerk: Array | None = None,
        turning_tool: Array | None = None,
    ) -> None:
        self._robot, self._turning_tool = robot, turning_tool
        self._timing = TimeOptimalTiming(robot, velocity, acceleration, effort, jerk=jerk)
        self._tool_velocity = np.concatenate([tool_velocity, [np.inf, np.inf]])
        self._tool_acceleration = np.concatenate([tool_acceleration, tool_acceleration])

    def trajectory(
        self, joint_path: JointPath, tool_path: CartesianPath, longest: float = np.inf
    ) -> Trajectory:
        """The timed motion along a path; see `PathTiming`.

        Raises:
            PlanningError: the robot cannot hold itself against gravity somewhere on the path.
            TooSlowError: it takes longer than `longest`, s.
        """
        limits = None
        if not np.isinf([self._tool_velocity, self._tool_acceleration]).all():
            limits = ToolLimits(
                lambda s: self._travel(joint_path, tool_path, s), self._tool_velocity, self._tool_acceleration
            )
        return self._timing.trajectory(joint_path, limits, longest)

    def _travel(self, joint_path: JointPath, tool_path: CartesianPath, s: Array) -> tuple[Array, Array]:
        """First and second derivatives over s (m,) of length and angle, and the normal parts, (m, 4) each."""
        if self._turning_tool is None:
            samples = tool_path.sample(s)
            x_s, x_ss = samples.x_s, samples.x_ss
        else:
            tools = np.tile(self._turning_tool, (len(s), 1))
            x_s, x_ss = tool_derivatives(self._robot, tools, *joint_path.evaluate(s))
        rate, along, across = travel(x_s, x_ss)
        return np.hstack([rate, np.zeros_like(rate)]), np.hstack([along, across])
