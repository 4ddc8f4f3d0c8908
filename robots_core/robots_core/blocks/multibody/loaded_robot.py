"""LoadedRobot: a robot that carries a payload."""

from collections.abc import Sequence

from robots_core.blocks.multibody.numerical_dynamics import body_model
from robots_core.blocks.multibody.payload import Payload, payload_of
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.model_parts import RigidDynamicsModel
from robots_core.robot_model.wrapped_robot import WrappedRobot
from robots_core.validation import Array


class LoadedRobot(WrappedRobot):
    """The same robot with a payload on tool0, in all torques and masses.

    Raises:
        InvalidInputError: the robot's `rigid_dynamics` are not those of its bodies under gravity.
    """

    def __init__(self, robot: BaseRobotModel, payload: Payload) -> None:
        super().__init__(robot)
        self.payload = payload
        model = body_model(robot, payload, floating=False)
        model.gravity.linear = robot.rigid_dynamics_model.gravity
        self._model = RigidDynamicsModel(model)

    @property
    def rigid_dynamics_model(self) -> RigidDynamicsModel:
        """The robot's, whose last body carries the payload."""
        return self._model

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """The robot's, with the payload."""
        return self._model.rigid_dynamics(q, q_dot, q_ddot)


def loaded_robot(robot: BaseRobotModel, payload: Sequence[float]) -> BaseRobotModel:
    """The robot with a payload by its numbers (see `payload_of`); the robot itself where it has no mass.

    Raises:
        InvalidInputError: numbers of no payload, or a robot whose dynamics are not those of its bodies.
    """
    carried = payload_of(payload)
    return LoadedRobot(robot, carried) if carried.mass > 0.0 else robot
