"""What a wrench on the tool does to the joints."""

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector


def joint_torques(robot: BaseRobotModel, q: Array, wrench: Array) -> Array:
    """Torques on the joints by a wrench on the tool, J^T f, (n,), N m (N).

    Args:
        robot: The robot.
        q: Joint positions, (n,), rad (m).
        wrench: Force (N) and torque (N m) on the tool about tool0, in tool0, (6,).

    Raises:
        InvalidInputError: a wrench of another shape or not finite.
    """
    _, T = robot.direct_kinematics(q)
    turned = finite_vector(wrench, 6, 'wrench').reshape(2, 3) @ T.T
    return np.asarray(robot.jacobian(q).T @ turned.ravel())
