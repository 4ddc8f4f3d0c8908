"""WrappedRobot: a robot that differs from another one in some respect."""

from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.collision_model import CollisionModel
from robots_core.robot_model.drive_data import DriveData
from robots_core.robot_model.kinematic_model import KinematicModel
from robots_core.robot_model.rigid_dynamics_model import RigidDynamicsModel
from robots_core.robot_model.robot_visualization import RobotVisualization
from robots_core.robot_model.structural_data import StructuralData
from robots_core.validation import Array


class WrappedRobot(BaseRobotModel):
    """All as the robot has it; subclasses override what differs.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: BaseRobotModel) -> None:
        self.robot = robot

    @property
    def axes_data(self) -> AxesData:
        """The robot's."""
        return self.robot.axes_data

    @property
    def drive_data(self) -> DriveData:
        """The robot's."""
        return self.robot.drive_data

    @property
    def orientation_convention(self) -> str:
        """The robot's."""
        return self.robot.orientation_convention

    @property
    def name(self) -> str:
        """The robot's."""
        return self.robot.name

    @property
    def structural_data(self) -> StructuralData:
        """The robot's."""
        return self.robot.structural_data

    @property
    def kinematic_model(self) -> KinematicModel:
        """The robot's."""
        return self.robot.kinematic_model

    @property
    def rigid_dynamics_model(self) -> RigidDynamicsModel:
        """The robot's."""
        return self.robot.rigid_dynamics_model

    @property
    def visualization(self) -> RobotVisualization:
        """The robot's."""
        return self.robot.visualization

    @property
    def collision_model(self) -> CollisionModel:
        """The robot's."""
        return self.robot.collision_model

    @property
    def description(self) -> str:
        """The robot's."""
        return self.robot.description

    @property
    def home(self) -> Array:
        """The robot's."""
        return self.robot.home

    def direct_kinematics(self, q: Array) -> tuple[Array, Array]:
        """The robot's."""
        return self.robot.direct_kinematics(q)

    def jacobian(self, q: Array) -> Array:
        """The robot's."""
        return self.robot.jacobian(q)

    def jacobian_der(self, q: Array, q_dot: Array) -> Array:
        """The robot's."""
        return self.robot.jacobian_der(q, q_dot)

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """The robot's."""
        return self.robot.rigid_dynamics(q, q_dot, q_ddot)

    def inverse_kinematics_analytic(self, r: Array, T: Array, *, q_near: Array | None = None) -> Array:
        """The robot's."""
        return self.robot.inverse_kinematics_analytic(r, T, q_near=q_near)
