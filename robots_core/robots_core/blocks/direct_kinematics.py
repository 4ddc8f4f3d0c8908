"""DirectKinematics: pose and Jacobian of a tool, for any robot (the paper's block of the same name)."""

import numpy as np

from robots_core.pose import Pose
from robots_core.robot_model.axes_data import AxesData
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

    @property
    def axes_limits(self) -> AxesData:
        """Limits of the axes (the paper's `AxesLimits`)."""
        return self.robot.axes_data

    def forward(self, q: Array) -> Pose:
        """Pose of the tool in the base frame.

        Args:
            q: Joint positions, (n,), rad (m); not checked against the limits.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        return Pose(*self.robot.direct_kinematics(q)) @ self.tool

    def jacobian(self, q: Array) -> Array:
        """Geometric Jacobian (6, n) at the tool point, base frame: linear rows (m/s), then angular (rad/s).

        A point at p = T r_tool from tool0 moves with v + omega x p, hence J_v - [p]x J_omega.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        _, T = self.robot.direct_kinematics(q)
        jacobian = self.robot.jacobian(q)
        return _shifted(jacobian, T @ self.tool.r)

    def jacobian_der(self, q: Array, q_dot: Array) -> Array:
        """Time derivative (6, n) of `jacobian` for joint velocities `q_dot` (n,).

        d/dt (J_v - [p]x J_omega) with dp/dt = omega x p.

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """
        jacobian_der = self.robot.jacobian_der(q, q_dot)
        _, T = self.robot.direct_kinematics(q)
        omega_jacobian = self.robot.jacobian(q)[3:]
        p = T @ self.tool.r
        p_dot = np.cross(omega_jacobian @ q_dot, p)
        shifted = _shifted(jacobian_der, p)
        shifted[:3] -= np.cross(p_dot, omega_jacobian, axisb=0).T
        return shifted


def _shifted(jacobian: Array, p: Array) -> Array:
    """The Jacobian of a point at `p` (3,) from the point of `jacobian` (6, n)."""
    shifted = jacobian.copy()
    shifted[:3] -= np.cross(p, jacobian[3:], axisb=0).T
    return shifted
