"""FreeFloatingDynamics: torques of a robot on a floating base, such as a satellite."""

import numpy as np
import pinocchio as pin

from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.dynamics import Dynamics
from robots_core.blocks.multibody.numerical_dynamics import body_model
from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_motion


class FreeFloatingDynamics(Dynamics):
    """Joint-space dynamics of a robot on a floating base with zero momentum.

    With the blocks b of the base and r of the joints, zero momentum gives the base the twist -S q_dot with S
    = M_bb^-1 M_br, and the joints the generalised mass matrix M_rr - M_br^T S and the generalised Jacobian
    J_r - J_b S (Umetani and Yoshida 1989). Gravity acts on base and arm alike and has no effect. Arguments
    are those of `Dynamics`, without `base`.

    Raises:
        InvalidInputError: a base without mass or inertia; a motion of the base; or a robot whose own dynamics
            are not those of its bodies.
    """

    def _prepare(self) -> None:
        check_base_body(self.robot)
        self._model = body_model(self.robot, self.payload, floating=True)
        self._model.armature[6:] = self._losses[0]
        self._data = self._model.createData()
        self._tool = self._model.getFrameId('tool0')
        self._configuration = pin.neutral(self._model)
        self._v = np.zeros(self._model.nv)

    def _use_base(self, base: BaseMotion) -> None:
        if base.turns or base.acceleration.any():
            raise InvalidInputError('a free-floating base moves by itself; it takes no BaseMotion')

    def _blocks(self, q: Array) -> tuple[Array, Array, Array]:
        """Mass matrix (6 + n, 6 + n), S (6, n) and generalised mass matrix (n, n)."""
        self._configuration[7:] = q
        M = pin.crba(self._model, self._data, self._configuration)
        S = np.linalg.solve(M[:6, :6], M[:6, 6:])
        return M, S, M[6:, 6:] - M[:6, 6:].T @ S

    def _bias(self, S: Array, q_dot: Array) -> Array:
        """Torques of base and joints (6 + n,) while nothing accelerates, after `_blocks`."""
        self._v[:6], self._v[6:] = -S @ q_dot, q_dot
        return np.asarray(pin.nonLinearEffects(self._model, self._data, self._configuration, self._v))

    def _loaded(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        _, S, reduced = self._blocks(q)
        bias = self._bias(S, q_dot)
        return np.ascontiguousarray(reduced), bias[6:] - S.T @ bias[:6] + self._friction(q_dot)

    def _tool_jacobian(self, q: Array) -> Array:
        _, S, _ = self._blocks(q)
        J = pin.computeFrameJacobian(
            self._model, self._data, self._configuration, self._tool, pin.LOCAL_WORLD_ALIGNED
        )
        return np.asarray(J[:, 6:] - J[:, :6] @ S)

    def base_wrench(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """Wrench of the base body on the arm for a motion (see `rigid_dynamics`).

        The arm exerts the opposite.

        Returns:
            Force (N) and moment (N m) at the base's origin, in base axes, (6,).
        """
        q, q_dot, q_ddot = finite_motion(q, q_dot, q_ddot, self._n)
        M, S, _ = self._blocks(q)
        push = self._bias(S, q_dot)[:6]
        acceleration = pin.Motion(-np.linalg.solve(M[:6, :6], push) - S @ q_ddot)
        twist, body = pin.Motion(self._v[:6]), self._model.inertias[1]
        force = body * acceleration + body.vxiv(twist)
        return -np.asarray(force.vector)


def check_base_body(robot: BaseRobotModel) -> None:
    """Check that the base of a robot may float.

    Raises:
        InvalidInputError: its base has no mass or no inertia.
    """
    bodies = robot.rigid_dynamics_model
    if not (bodies.masses[0] > 0.0 and np.linalg.eigvalsh(bodies.inertias[0])[0] > 0.0):
        raise InvalidInputError(
            f'the base of robot {robot.name!r} has no mass or no inertia; a free-floating base needs both'
        )
