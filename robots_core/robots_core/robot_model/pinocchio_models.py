"""KinematicModel and RigidDynamicsModel computed by Pinocchio."""

import numpy as np
import pinocchio as pin

from robots_core.robot_model.model_parts import KinematicModel, RigidDynamicsModel
from robots_core.validation import Array, finite_motion, finite_state, finite_vector, read_only


class PinocchioKinematicModel(KinematicModel):
    """Frames of all axes from a Pinocchio model with one position per joint."""

    def __init__(self, model: pin.Model) -> None:
        self._model = model
        self._data = model.createData()

    def frame_axes(self, q: Array) -> tuple[Array, Array]:
        """See `KinematicModel.frame_axes`."""
        n = self._model.nv
        pin.forwardKinematics(self._model, self._data, finite_vector(q, n, 'q'))
        r, T = np.empty((n, 3)), np.empty((n, 3, 3))
        for axis in range(n):
            placement = self._data.oMi[axis + 1]
            r[axis], T[axis] = placement.translation, placement.rotation
        return r, T


class PinocchioRigidDynamicsModel(RigidDynamicsModel):
    """Recursive Newton-Euler and composite rigid body algorithms (Featherstone 2008) by Pinocchio."""

    def __init__(self, model: pin.Model) -> None:
        self._model = model
        self._data = model.createData()
        self._n = model.nv
        bodies = list(model.inertias)
        self.masses = read_only([body.mass for body in bodies])
        self.centers_of_mass = read_only([body.lever for body in bodies])
        self.inertias = read_only([body.inertia for body in bodies])
        self.gravity = read_only(model.gravity.linear)

    def torques(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """See `RigidDynamicsModel.torques`."""
        return np.asarray(pin.rnea(self._model, self._data, *finite_motion(q, q_dot, q_ddot, self._n)))

    def mass_matrix(self, q: Array) -> Array:
        """See `RigidDynamicsModel.mass_matrix`."""
        # From Python, Pinocchio hands out both triangles.
        return np.asarray(pin.crba(self._model, self._data, finite_vector(q, self._n, 'q')))

    def bias_torques(self, q: Array, q_dot: Array) -> Array:
        """See `RigidDynamicsModel.bias_torques`."""
        q, q_dot = finite_state(q, q_dot, self._n)
        return np.asarray(pin.nonLinearEffects(self._model, self._data, q, q_dot))
