"""LinearCartesianDynamicProgramming: a straight line of the tool in the shortest time."""

from typing import Any

import numpy as np

from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import positive
from robots_planning.path_kinematics.configuration_graph import ConfigurationGraph
from robots_planning.timing.dynamic_programming_timing import DynamicProgrammingTiming
from robots_planning.trajectory_generators.base import LIMIT_MARGIN
from robots_planning.trajectory_generators.line_generator import LineGenerator


class LinearCartesianDynamicProgramming(LineGenerator):
    """The tool moves on a straight line and turns about one axis, in the shortest time.

    Velocity, acceleration and torque limits of the axes hold everywhere. The speed along the line is found by
    dynamic programming over path and speed (Shin and McKay 1986; Pham and Pham 2018); jumps of acceleration
    become short ramps. Close to a singularity the motion slows down; in one, the tool may stand still while
    the axes turn to a configuration in which the line can be continued. Robots with more than six axes use
    their self-motion (see `ConfigurationGraph`).

    Args:
        robot: The robot.
        torque: Keep the axes' torque limits too.
        cartesian_speed: Highest speed of the tool, m/s; none by default.
        cartesian_acceleration: Highest acceleration of the tool along the line, m/s^2; none by default.
        rotation_speed: Highest angular speed of the tool, rad/s; none by default.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2; none by default.
        jerk_limited: Keep the axes' jerk limits too, by smoothing the time law; no longer the shortest time.
        options: See `TrajectoryGenerator`.

    Raises:
        InvalidInputError: an option that is not valid.
    """

    keeps_torque = True

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        torque: bool = True,
        cartesian_speed: float | None = None,
        cartesian_acceleration: float | None = None,
        rotation_speed: float | None = None,
        rotation_acceleration: float | None = None,
        jerk_limited: bool = False,
        **options: Any,
    ) -> None:
        super().__init__(robot, **options)
        self.keeps_torque = torque
        if self.hold == POSE:
            self.configuration_graph = ConfigurationGraph(robot, self.path_kinematics, self.tool)
        self.timing = DynamicProgrammingTiming(
            robot,
            self.velocity,
            self.acceleration,
            robot.axes_data.effort * (1.0 - LIMIT_MARGIN) if torque else None,
            tool_velocity=np.array(
                [
                    _limit(cartesian_speed, 'cartesian_speed', 'm/s'),
                    _limit(rotation_speed, 'rotation_speed', 'rad/s'),
                ]
            ),
            tool_acceleration=np.array(
                [
                    _limit(cartesian_acceleration, 'cartesian_acceleration', 'm/s^2'),
                    _limit(rotation_acceleration, 'rotation_acceleration', 'rad/s^2'),
                ]
            ),
            jerk=self.jerk if jerk_limited else None,
            turning_tool=None if self.hold == POSE else self.tool_position,
        )


def _limit(value: float | None, name: str, unit: str) -> float:
    return np.inf if value is None else positive(value, name, unit)
