"""NumericalDynamics: the dynamics of a robot's bodies on a base with any motion."""

from typing import Any

import numpy as np
import pinocchio as pin

from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.blocks.multibody.dynamics import Dynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.kernels.chain_dynamics import chain_dynamics_of
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.model_parts import of_motion
from robots_core.validation import Array, finite_motion


class NumericalDynamics(Dynamics):
    """The bodies of the robot's `RigidDynamicsModel` and the payload, on any base.

    Also computes the wrench in the mount. Recursive Newton-Euler, composite rigid body and articulated body
    algorithms by Pinocchio (Featherstone 2008), on a floating base if it turns or for the mount.
    Acceleration of the base is equivalent to opposite gravity. Arguments are those of `Dynamics`.

    Raises:
        InvalidInputError: a robot whose own dynamics are not those of its bodies; use `FunctionDynamics`.
    """

    def _prepare(self) -> None:
        robot, payload = self.robot, self.payload
        self.gravity = robot.rigid_dynamics_model.gravity
        """Acceleration of free fall of an upright base at rest, (3,), m/s^2."""
        self.model = body_model(robot, payload, floating=True)
        """The bodies on a floating base; its configuration: base position and quaternion, then q."""
        self.model.armature[6:] = self._losses[0]
        self._data = self.model.createData()
        self._configuration = pin.neutral(self.model)
        self._v, self._a = np.zeros(self.model.nv), np.zeros(self.model.nv)
        # The same on a base that does not turn, in half the time.
        self._fixed = body_model(robot, payload, floating=False)
        self._fixed.armature = np.array(self._losses[0])
        self._fixed_data = self._fixed.createData()

    def _use_base(self, base: BaseMotion) -> None:
        self._turns = base.turns
        fall = base.free_fall(self.gravity)
        self._fixed.gravity.linear = fall
        self._a[:3] = -fall
        self._a[3:6], self._v[3:6] = base.angular_acceleration, base.angular_velocity

    def torques(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """See `Dynamics.torques`; one recursion, without the mass matrix."""
        tau = (
            self._full(*finite_motion(q, q_dot, q_ddot, self._n))[6:]
            if self._turns
            else of_motion(pin.rnea, self._fixed, self._fixed_data, q, q_dot, q_ddot)
        )
        return tau + self._friction(q_dot) if self._resists else tau

    def accelerations(self, q: Array, q_dot: Array, tau: Array) -> Array:
        """See `Dynamics.accelerations`; articulated bodies where no axis is held by friction."""
        if self._turns:
            return super().accelerations(q, q_dot, tau)
        if self._resists:
            q, q_dot, tau = finite_motion(q, q_dot, tau, self._n)
            if not q_dot.all():
                return super().accelerations(q, q_dot, tau)
            tau = tau - self._friction(q_dot)
        return of_motion(pin.aba, self._fixed, self._fixed_data, q, q_dot, tau)

    def base_wrench(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """Wrench of the mount on the robot, base body included, for a motion (see `rigid_dynamics`).

        The robot exerts the opposite on its mount. Rotors are without effect on it.

        Returns:
            Force (N) and moment (N m) at the base's origin, in base axes, (6,).
        """
        return self._full(*finite_motion(q, q_dot, q_ddot, self._n))[:6].copy()

    def _full(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        self._configuration[7:], self._v[6:], self._a[6:] = q, q_dot, q_ddot
        return np.asarray(pin.rnea(self.model, self._data, self._configuration, self._v, self._a))

    def _loaded(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        M: Array = pin.crba(self._fixed, self._fixed_data, q)
        tau_aux: Array = (
            self._full(q, q_dot, self._no_motion)[6:]
            if self._turns
            else pin.nonLinearEffects(self._fixed, self._fixed_data, q, q_dot)
        )
        return M, tau_aux + self._friction(q_dot) if self._resists else tau_aux


def body_model(robot: BaseRobotModel, payload: Payload, *, floating: bool) -> Any:
    """A robot's bodies as a Pinocchio model without gravity, its base floating or fixed to the world.

    Raises:
        InvalidInputError: the robot's `rigid_dynamics` are not those of its bodies under gravity.
    """
    chain, bodies = chain_dynamics_of(robot).chain, robot.rigid_dynamics_model
    r, T = robot.kinematic_model.frame_axes(np.zeros(robot.num_axes))
    axes = robot.axes_data
    model = pin.Model()
    model.gravity = pin.Motion.Zero()
    parent = 0
    if floating:
        parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), 'base')
    inertia = pin.Inertia(bodies.masses[0], bodies.centers_of_mass[0], bodies.inertias[0])
    model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
    before = pin.SE3.Identity()
    for i, name in enumerate(axes.names):
        frame = pin.SE3(T[i], r[i])
        direction = T[i].T @ chain.directions[i]
        kind = pin.JointModelPrismaticUnaligned if axes.prismatic[i] else pin.JointModelRevoluteUnaligned
        parent = model.addJoint(parent, kind(direction), before.actInv(frame), name)
        inertia = pin.Inertia(bodies.masses[i + 1], bodies.centers_of_mass[i + 1], bodies.inertias[i + 1])
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        before = frame
    tool = Pose(before.translation, before.rotation).inverse() @ Pose(
        *robot.direct_kinematics(np.zeros(robot.num_axes))
    )
    load = payload.seen_from(tool)
    model.appendBodyToJoint(parent, pin.Inertia(load.mass, load.center, load.inertia), pin.SE3.Identity())
    model.addFrame(pin.Frame('tool0', parent, pin.SE3(tool.T, tool.r), pin.FrameType.OP_FRAME))
    return model
