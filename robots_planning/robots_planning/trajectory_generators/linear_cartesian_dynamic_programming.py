"""LinearCartesianDynamicProgramming: a straight line of the tool in the shortest time."""

from typing import Any

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.trajectory_generators.cartesian_generator import TOOL_LIMITS
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited


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
        super().__init__(robot, planner='dynamic_programming', **unlimited | options)
