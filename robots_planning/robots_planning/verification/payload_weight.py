"""Whether the axes can hold what the robot carries."""

from typing import Final

import numpy as np

from robots_core.errors import PlanningError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

PLACES: Final = 20  # on a path, at which weights are compared


def check_weight(trajectory: Trajectory, robot: BaseRobotModel, mass: float) -> None:
    """Refuse a motion with a payload on whose path the weight alone is past the torque of an axis.

    Args:
        trajectory: The motion.
        robot: The robot with its payload.
        mass: Of the payload, kg; 0 for none, which is not refused.

    Raises:
        PlanningError: an axis cannot hold it; names axis, torque, limit and place.
    """
    if mass == 0.0:
        return
    position = trajectory.sample(np.linspace(0.0, trajectory.duration, PLACES))[0]
    still = np.zeros(robot.num_axes)
    weight: Array = np.abs([robot.rigid_dynamics(q, still, still)[2] for q in position])
    axes = robot.axes_data
    place, axis = np.unravel_index(int((weight / axes.effort).argmax()), weight.shape)
    if weight[place, axis] > axes.effort[axis]:
        unit = axes.unit(int(axis), 'torque')
        raise PlanningError(
            f'the robot cannot hold its payload of {mass:g} kg: {axes.names[axis]} needs '
            f'{weight[place, axis]:.4g} {unit} for the weight, its limit is {axes.effort[axis]:g} {unit}, at '
            f'{100.0 * place / (PLACES - 1):.0f} % of the motion'
        )
