"""FunctionDynamics: the dynamics of a robot by its own function."""

from dataclasses import replace
from functools import cached_property

import numpy as np

from robots_core.blocks.direct_kinematics import shifted_jacobian, shifted_jacobian_der
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.dynamics import Dynamics
from robots_core.errors import InvalidInputError
from robots_core.kernels.chain_dynamics import ChainDynamics, chain_dynamics_of
from robots_core.validation import Array, read_only


class FunctionDynamics(Dynamics):
    """The robot's own `rigid_dynamics`, with payload, base, friction and rotors added.

    Payload by the projection of its Newton-Euler equations through the Jacobian at its centre of mass
    (Kane); an inclined or accelerated base by the difference in gravity. A base that turns needs
    `NumericalDynamics`. Arguments are those of `Dynamics`.

    Raises:
        InvalidInputError: a base that turns; or a payload or an inclined or accelerated base with a robot
            whose own dynamics are not those of its bodies, so that its gravity is not known.
    """

    def _prepare(self) -> None:
        self._loses = bool(self._losses.any())
        self._loads = self.payload.mass > 0.0 or bool(self.payload.inertia.any())

    def _use_base(self, base: BaseMotion) -> None:
        if base.turns:
            raise InvalidInputError(
                f'FunctionDynamics does not support a base that turns (angular velocity '
                f'{base.angular_velocity.tolist()} rad/s); use NumericalDynamics'
            )
        self._inclined = bool(base.acceleration.any()) or not np.array_equal(base.T, np.eye(3))
        if self._inclined or self._loads:
            gravity = self._chain.gravity
            self._fall = base.free_fall(gravity)
            self._inclined_chain = replace(self._chain, gravity=read_only(self._fall - gravity))

    @cached_property
    def _chain(self) -> ChainDynamics:
        return chain_dynamics_of(self.robot)

    def _loaded(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        _, M, tau_aux = self.robot.rigid_dynamics(q, q_dot, self._no_motion)
        M, tau_aux = np.array(M, order='C'), np.array(tau_aux)
        if self._inclined:
            tau_aux += self._inclined_chain.mass_matrix_and_bias(np.array(q), self._no_motion)[1]
        if self._loads:
            self._add_payload(q, q_dot, M, tau_aux)
        if self._loses:
            M.flat[:: self._n + 1] += self._losses[0]
            tau_aux += self._friction(q_dot)
        return M, tau_aux

    def _add_payload(self, q: Array, q_dot: Array, M: Array, tau_aux: Array) -> None:
        mass = self.payload.mass
        T, J, J_der = self.robot.orientation_and_jacobians(q, q_dot)
        center = T @ self.payload.center
        inertia = T @ self.payload.inertia @ T.T
        # Acceleration of the payload while no axis accelerates.
        drift = shifted_jacobian_der(J_der, J, q_dot, center) @ q_dot
        shifted = shifted_jacobian(J, center)
        linear, angular = shifted[:3], shifted[3:]
        omega = angular @ q_dot
        M += mass * linear.T @ linear + angular.T @ inertia @ angular
        tau_aux += mass * linear.T @ (drift[:3] - self._fall)
        tau_aux += angular.T @ (inertia @ drift[3:] + np.cross(omega, inertia @ omega))
