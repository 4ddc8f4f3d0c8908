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
        timing: With the limits of the axes.
        robot: The robot.
        tool: Highest speed (m/s), acceleration, angular speed (rad/s) and angular acceleration of the tool,
            (4,); infinite for none.
        turning_tool: Position in tool0, (3,) m, of a tool that turns as the arm must, whose speeds are those
            of the axes' path; None for a tool that has the orientations of its own path.
    """

    def __init__(
        self, timing: TimeOptimalTiming, robot: BaseRobotModel, tool: Array, *, turning_tool: Array | None
    ) -> None:
        self._timing, self._robot, self._turning_tool = timing, robot, turning_tool
        self._limited = bool(np.isfinite(tool).any())
        self._tool_velocity = np.concatenate([tool[::2], [np.inf, np.inf]])
        self._tool_acceleration = np.concatenate([tool[1::2], tool[1::2]])

    def trajectory(
        self, joint_path: JointPath, tool_path: CartesianPath, longest: float = np.inf
    ) -> Trajectory:
        """The timed motion from rest to rest along a path.

        Args:
            joint_path: Joint positions over s.
            tool_path: Poses of the tool over the same s.
            longest: Longest duration that the caller accepts, s; planning stops once it is exceeded.

        Raises:
            PlanningError: the robot cannot hold itself against gravity somewhere on the path.
            TooSlowError: it takes longer than `longest`, s.
        """
        limits = None
        if self._limited:
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
