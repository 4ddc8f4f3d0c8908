"""WrappedRobot: a robot that differs from another one in some respect."""

from operator import attrgetter
from typing import Any

from robots_core.robot_model.base_robot_model import BaseRobotModel


def _as_the_robot_has(name: str) -> Any:
    return property(attrgetter(f'robot.{name}'))


class WrappedRobot(BaseRobotModel):
    """All as the robot has it; subclasses override what differs."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self.robot = robot

    name = _as_the_robot_has('name')
    axes_data = _as_the_robot_has('axes_data')
    drive_data = _as_the_robot_has('drive_data')
    substitutions = _as_the_robot_has('substitutions')
    structural_data = _as_the_robot_has('structural_data')
    kinematic_model = _as_the_robot_has('kinematic_model')
    rigid_dynamics_model = _as_the_robot_has('rigid_dynamics_model')
    visualization = _as_the_robot_has('visualization')
    collision_model = _as_the_robot_has('collision_model')
    description = _as_the_robot_has('description')
    home = _as_the_robot_has('home')
    orientation_convention = _as_the_robot_has('orientation_convention')
    base_link = _as_the_robot_has('base_link')
    direct_kinematics = _as_the_robot_has('direct_kinematics')
    pose = _as_the_robot_has('pose')
    tool_poses = _as_the_robot_has('tool_poses')
    jacobian = _as_the_robot_has('jacobian')
    jacobian_der = _as_the_robot_has('jacobian_der')
    orientation_and_jacobians = _as_the_robot_has('orientation_and_jacobians')
    rigid_dynamics = _as_the_robot_has('rigid_dynamics')
    inverse_kinematics_analytic = _as_the_robot_has('inverse_kinematics_analytic')
