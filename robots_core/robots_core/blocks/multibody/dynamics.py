"""Dynamics: torques, mass matrix and forward dynamics of a robot with payload, friction and rotors."""

from abc import ABC, abstractmethod

import numpy as np

from robots_core.blocks.drives.friction_kernel import accelerations
from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_motion, finite_state, finite_vector


class Dynamics(ABC):
    """Base of the paper's dynamics blocks: the rigid robot by a subclass, friction and rotors here.

    tau = M q_ddot + tau_aux, where M has the reflected inertia of the rotors on its diagonal (gear ratio
    squared times rotor inertia, without the rotors' gyroscopic torques) and tau_aux the friction of moving
    axes, coulomb sign(q_dot) + viscous q_dot. An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        payload: Payload on tool0: tool, workpiece, or their sum.
        base: Orientation and motion of the base.
        friction: With the friction of the robot's `axes_data`.
        rotors: With the rotor inertias of the robot's `axes_data`.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        payload: Payload = NOTHING,
        base: BaseMotion | None = None,
        friction: bool = True,
        rotors: bool = True,
    ) -> None:
        self.robot = robot
        self.payload = payload
        self._n = robot.num_axes
        axes = robot.axes_data
        # Rows: reflected inertia, Coulomb and viscous friction, for compiled code.
        self._losses = np.zeros((3, self._n))
        if rotors:
            self._losses[0] = axes.reflected_inertia
        if friction:
            self._losses[1:] = axes.coulomb_friction, axes.viscous_friction
        self._resists = bool(self._losses[1:].any())
        self._no_motion = np.zeros(self._n)
        # Compiled code is specialised for one memory layout; another would take many seconds to compile.
        self._q_dot, self._tau = np.zeros((2, self._n))
        self._prepare()
        self.base = BaseMotion() if base is None else base

    @property
    def base(self) -> BaseMotion:
        """Orientation and motion of the base; may be set between two calls."""
        return self._base

    @base.setter
    def base(self, base: BaseMotion) -> None:
        self._use_base(base)
        self._base = base

    @abstractmethod
    def _prepare(self) -> None:
        """Prepare the computation for this robot with its payload, for any base."""

    @abstractmethod
    def _use_base(self, base: BaseMotion) -> None:
        """Set the base for the following computations."""

    @abstractmethod
    def _loaded(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        """Mass matrix (n, n) and bias torques (n,), own arrays: bodies, payload and losses."""

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """Torques of the drives for a motion, at the joints.

        Args:
            q: Joint positions, (n,), rad (m).
            q_dot: Joint velocities, (n,), rad/s.
            q_ddot: Joint accelerations, (n,), rad/s^2.

        Returns:
            tau: Torques (n,), N m (N).
            M: Mass matrix (n, n).
            tau_aux: Torques of Coriolis, centrifugal and gravitational forces, and of friction, (n,).

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """
        q, q_dot, q_ddot = finite_motion(q, q_dot, q_ddot, self._n)
        M, tau_aux = self._loaded(q, q_dot)
        return M.dot(q_ddot) + tau_aux, M, tau_aux

    def torques(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """Torques of the drives for a motion (inverse dynamics), (n,), N m (N); see `rigid_dynamics`."""
        return self.rigid_dynamics(q, q_dot, q_ddot)[0]

    def mass_matrix(self, q: Array) -> Array:
        """Mass matrix (n, n), kg m^2, with rotors and payload."""
        q = finite_vector(q, self._n, 'q')
        return self._loaded(q, self._no_motion)[0]

    def bias_torques(self, q: Array, q_dot: Array) -> Array:
        """Torques (n,), N m, for a motion at constant speed; friction included."""
        return self._loaded(*finite_state(q, q_dot, self._n))[1]

    def _friction(self, q_dot: Array) -> Array:
        return np.asarray(self._losses[1] * np.sign(q_dot) + self._losses[2] * q_dot)

    def accelerations(self, q: Array, q_dot: Array, tau: Array) -> Array:
        """Joint accelerations for torques of the drives (forward dynamics).

        An axis at rest stays there until the others and its drive overcome its friction.

        Args:
            q: Joint positions, (n,), rad (m).
            q_dot: Joint velocities, (n,), rad/s.
            tau: Torques, (n,), N m (N).

        Returns:
            (n,), rad/s^2 (m/s^2).

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """
        q, q_dot, tau = finite_motion(q, q_dot, tau, self._n)
        M, tau_aux = self._loaded(q, q_dot)
        self._q_dot[:] = q_dot
        np.subtract(tau, tau_aux, self._tau)
        return np.asarray(accelerations(self._losses, self._q_dot, M, self._tau))

    def external_wrench(self, q: Array, q_dot: Array, q_ddot: Array, tau: Array) -> Array:
        """Wrench that the surroundings exert on the tool, estimated from torques of the drives.

        Least squares of J^T F = M q_ddot + tau_aux - tau. With fewer than six axes, or near a singularity,
        the part without effect on any axis is zero.

        Returns:
            Force (N) and moment (N m) at tool0, (6,), base frame.

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """
        rest = self.torques(q, q_dot, q_ddot) - finite_vector(tau, self._n, 'tau')
        return np.asarray(np.linalg.lstsq(self._tool_jacobian(q).T, rest, rcond=WRENCH_CUTOFF)[0])

    def _tool_jacobian(self, q: Array) -> Array:
        """Jacobian of tool0, (6, n), base frame."""
        return self.robot.jacobian(q)


# Directions in which a motion takes a hundred times the joint angles of the best one are left out.
WRENCH_CUTOFF = 1e-2
