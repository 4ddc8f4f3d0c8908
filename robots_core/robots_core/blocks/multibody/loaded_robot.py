"""LoadedRobot: a robot that carries a payload."""

from collections.abc import Sequence

import numpy as np

from robots_core.blocks.inverse_kinematics.chain_dynamics import ChainDynamics
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.loaded_chain import loaded_chain
from robots_core.blocks.multibody.payload import Payload, payload_of, united
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.rigid_dynamics_model import RigidDynamicsModel
from robots_core.robot_model.wrapped_robot import WrappedRobot
from robots_core.validation import Array, finite_vector, read_only


class LoadedRobot(WrappedRobot):
    """The same robot with a payload on tool0, in all torques and masses.

    Args:
        robot: The robot.
        payload: What it carries.

    Raises:
        InvalidInputError: the robot's `rigid_dynamics` are not those of its bodies under gravity.
    """

    def __init__(self, robot: BaseRobotModel, payload: Payload) -> None:
        super().__init__(robot)
        self.payload = payload
        self._model = _LoadedModel(robot, payload)

    @property
    def rigid_dynamics_model(self) -> RigidDynamicsModel:
        """The robot's, whose last body carries the payload."""
        return self._model

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """The robot's, with the payload."""
        M, tau_aux = self._model.dynamics(q, q_dot)
        return M @ finite_vector(q_ddot, self.num_axes, 'q_ddot') + tau_aux, M, tau_aux


def loaded_robot(robot: BaseRobotModel, payload: Sequence[float]) -> BaseRobotModel:
    """The robot with a payload by its numbers (see `payload_of`); the robot itself where it has no mass.

    Raises:
        InvalidInputError: numbers of no payload, or a robot whose dynamics are not those of its bodies.
    """
    carried = payload_of(payload)
    return LoadedRobot(robot, carried) if carried.mass > 0.0 else robot


class _LoadedModel(RigidDynamicsModel):
    def __init__(self, robot: BaseRobotModel, payload: Payload) -> None:
        self._chain: ChainDynamics = loaded_chain(robot, payload, BaseMotion())
        own, n = robot.rigid_dynamics_model, robot.num_axes
        r, T = robot.kinematic_model.frame_axes(np.zeros(n))
        tool = Pose(r[-1], T[-1]).inverse() @ Pose(*robot.direct_kinematics(np.zeros(n)))
        load = payload.seen_from(tool)
        masses, centers, inertias = (np.array(a) for a in (own.masses, own.centers_of_mass, own.inertias))
        masses[-1], centers[-1], inertias[-1] = united(
            (masses[-1], centers[-1], inertias[-1]), (load.mass, load.center, load.inertia)
        )
        self.masses, self.centers_of_mass = read_only(masses), read_only(centers)
        self.inertias = read_only(inertias)
        self._n = n

    def dynamics(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        """Mass matrix (n, n) and bias torques (n,)."""
        return self._chain.mass_matrix_and_bias(
            np.array(finite_vector(q, self._n, 'q')), np.array(finite_vector(q_dot, self._n, 'q_dot'))
        )

    def torques(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """See `RigidDynamicsModel`."""
        M, bias = self.dynamics(q, q_dot)
        return np.asarray(M @ finite_vector(q_ddot, self._n, 'q_ddot') + bias)

    def mass_matrix(self, q: Array) -> Array:
        """See `RigidDynamicsModel`."""
        return self.dynamics(q, np.zeros(self._n))[0]

    def bias_torques(self, q: Array, q_dot: Array) -> Array:
        """See `RigidDynamicsModel`."""
        return self.dynamics(q, q_dot)[1]
