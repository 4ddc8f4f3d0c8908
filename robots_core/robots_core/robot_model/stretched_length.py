"""How long a robot is that is stretched."""

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel


def stretched_length(robot: BaseRobotModel) -> float:
    """Length of the stretched robot, m: the distances from the base over all axes to tool0."""
    r, _ = robot.kinematic_model.frame_axes(robot.home)
    tool0, _ = robot.direct_kinematics(robot.home)
    points = np.vstack([np.zeros(3), r, tool0])
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
