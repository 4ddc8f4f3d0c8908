"""SlowedRobot: a robot that is taken to be slower than it is."""

from dataclasses import replace

from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.wrapped_robot import WrappedRobot
from robots_planning.trajectory_generators.trajectory_generator import usable_fraction


class SlowedRobot(WrappedRobot):
    """The same robot with parts of its velocity and acceleration limits, for blocks that use all they have.

    Args:
        robot: The robot.
        speed_fraction: Part of the velocity limits, in (0, 1].
        acceleration_fraction: Part of the acceleration and jerk limits, in (0, 1].

    Raises:
        InvalidInputError: a fraction outside (0, 1].
    """

    def __init__(self, robot: BaseRobotModel, *, speed_fraction: float, acceleration_fraction: float) -> None:
        super().__init__(robot)
        speed = usable_fraction(speed_fraction, 'speed_fraction')
        acceleration = usable_fraction(acceleration_fraction, 'acceleration_fraction')
        axes = robot.axes_data
        self._axes_data = replace(
            axes,
            velocity=speed * axes.velocity,
            acceleration=acceleration * axes.acceleration,
            jerk=acceleration * axes.jerk,
        )

    @property
    def axes_data(self) -> AxesData:
        """The lowered limits."""
        return self._axes_data
