"""SlowedRobot: a robot that is taken to be slower than it is."""

from __future__ import annotations

from dataclasses import replace

from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.collision_model import CollisionModel
from robots_core.robot_model.kinematic_model import KinematicModel
from robots_core.robot_model.rigid_dynamics_model import RigidDynamicsModel
from robots_core.robot_model.robot_visualization import RobotVisualization
from robots_core.robot_model.structural_data import StructuralData
from robots_core.validation import Array
from robots_planning.trajectory_generators.base import usable_fraction


class SlowedRobot(BaseRobotModel):
    """The same robot with parts of its velocity and acceleration limits, for blocks that use all they have.

    Args:
        robot: The robot.
        speed_fraction: Part of the velocity limits, in (0, 1].
        acceleration_fraction: Part of the acceleration and jerk limits, in (0, 1].

    Raises:
        InvalidInputError: a fraction outside (0, 1].
    """

    def __init__(self, robot: BaseRobotModel, *, speed_fraction: float, acceleration_fraction: float) -> None:
        self._robot = robot
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

    @property
    def name(self) -> str:
        """The robot's."""
        return self._robot.name

    @property
    def structural_data(self) -> StructuralData:
        """The robot's."""
        return self._robot.structural_data

    @property
    def kinematic_model(self) -> KinematicModel:
        """The robot's."""
        return self._robot.kinematic_model

    @property
    def rigid_dynamics_model(self) -> RigidDynamicsModel:
        """The robot's."""
        return self._robot.rigid_dynamics_model

    @property
    def visualization(self) -> RobotVisualization:
        """The robot's."""
        return self._robot.visualization

    @property
    def collision_model(self) -> CollisionModel:
        """The robot's."""
        return self._robot.collision_model

    @property
    def description(self) -> str:
        """The robot's."""
        return self._robot.description

    @property
    def home(self) -> Array:
        """The robot's."""
        return self._robot.home

    def direct_kinematics(self, q: Array) -> tuple[Array, Array]:
        """The robot's."""
        return self._robot.direct_kinematics(q)

    def jacobian(self, q: Array) -> Array:
        """The robot's."""
        return self._robot.jacobian(q)

    def jacobian_der(self, q: Array, q_dot: Array) -> Array:
        """The robot's."""
        return self._robot.jacobian_der(q, q_dot)

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """The robot's."""
        return self._robot.rigid_dynamics(q, q_dot, q_ddot)
