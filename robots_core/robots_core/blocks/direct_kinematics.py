"""DirectKinematics: pose and Jacobian of a tool, for any robot (the paper's block of the same name)."""

import pinocchio as pin

from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array


class DirectKinematics:
    """Direct kinematics of a robot that carries a tool.

    Args:
        robot: The robot.
        tool: Pose of the tool centre point in tool0; identity: tool0 itself.
    """

    def __init__(self, robot: BaseRobotModel, *, tool: Pose | None = None) -> None:
        self.robot = robot
        self.tool = Pose.identity() if tool is None else tool

    def forward(self, q: Array) -> Pose:
        """Pose of the tool in the base frame.

        Args:
            q: Joint positions, (n,), rad (m); not checked against the limits.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        return self.robot.pose(q) @ self.tool

    def jacobian(self, q: Array) -> Array:
        """Geometric Jacobian (6, n) at the tool point, base frame: linear rows (m/s), then angular (rad/s).

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        _, T = self.robot.direct_kinematics(q)
        return shifted_jacobian(self.robot.jacobian(q), T @ self.tool.r)

    def jacobian_der(self, q: Array, q_dot: Array) -> Array:
        """Time derivative (6, n) of `jacobian` for joint velocities `q_dot` (n,).

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """
        T, J, J_der = self.robot.orientation_and_jacobians(q, q_dot)
        return shifted_jacobian_der(J_der, J, q_dot, T @ self.tool.r)


def shifted_jacobian(jacobian: Array, p: Array) -> Array:
    """The Jacobian of a point at `p` (3,) from the point of `jacobian` (6, n).

    A point at p moves with v + omega x p, hence J_v - [p]x J_omega.
    """
    shifted = jacobian.copy()
    shifted[:3] -= pin.skew(p) @ jacobian[3:]  # np.cross takes ten times as long
    return shifted


def shifted_jacobian_der(jacobian_der: Array, jacobian: Array, q_dot: Array, p: Array) -> Array:
    """Time derivative of `shifted_jacobian`, of those of the Jacobian and the Jacobian itself, (6, n).

    d/dt (J_v - [p]x J_omega) with dp/dt = omega x p.
    """
    angular = jacobian[3:]
    shifted = shifted_jacobian(jacobian_der, p)
    shifted[:3] -= pin.skew(pin.skew(angular @ q_dot) @ p) @ angular
    return shifted
