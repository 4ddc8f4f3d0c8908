"""FloatingBase: how a satellite moves while its arm moves, by the conservation of momentum."""

from math import ceil
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robots_core.blocks.multibody.free_floating_dynamics import check_base_body
from robots_core.blocks.multibody.numerical_dynamics import body_model
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_state, finite_vector, positive, read_only

LONGEST_STEP: Final = 5e-3  # s


class FloatingBase:
    """Base of a robot in orbit whose joints are moved by their drives, with reaction wheels.

    No force acts from outside, so that the momentum is constant. It gives the base its twist,
    V = M_bb^-1 (h - M_br q_dot - h_w), where h is the momentum in base coordinates and h_w that of the
    wheels (Umetani and Yoshida 1989; wheels as in a gyrostat, Hughes 2004). The pose is its integral along
    the cubic through positions and velocities of the joints, by the classical Runge-Kutta method on
    displacements (Munthe-Kaas 1999). `FreeFloatingRobot` is the same robot driven by torques.

    Args:
        robot: The robot, without gravity; its base body needs a mass and an inertia.
        q: Joint positions at the start, (n,), rad (m), at rest; the base is at the world's origin.
        twist: Velocity of the base (m/s), then angular velocity (rad/s), (6,), in base axes.
        payload: Payload on tool0.

    Raises:
        InvalidInputError: a base without mass or inertia, a robot with gravity, or values of another shape or
            not finite.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        q: ArrayLike,
        *,
        twist: ArrayLike = (0.0,) * 6,
        payload: Payload = NOTHING,
    ) -> None:
        check_base_body(robot)
        gravity = robot.rigid_dynamics_model.gravity
        if gravity.any():
            raise InvalidInputError(
                f'robot {robot.name!r} has gravity {gravity.tolist()} m/s^2; a base that floats '
                f'needs a robot without: {robot.name.partition("?")[0]}?gravity=0,0,0'
            )
        self.robot, self._n = robot, robot.num_axes
        self.wheel_momentum = read_only(np.zeros(3))
        """Angular momentum of the wheels, (3,), N m s, in base axes."""
        self._place = pin.SE3.Identity()
        self._q = np.array(finite_vector(q, self._n, 'q'))
        self._q_dot, self._q_ddot = np.zeros((2, self._n))
        self._twist = np.array(finite_vector(twist, 6, 'twist'))
        self._wheel_torque = np.zeros(3)
        self._carry(payload)
        self._h = self.momentum

    def _carry(self, payload: Payload) -> None:
        self.payload = payload
        self._model = body_model(self.robot, payload, floating=True)
        self._data, self._seen = self._model.createData(), self._model.createData()
        self._configuration = pin.neutral(self._model)

    @property
    def pose(self) -> Pose:
        """Pose of the base in the world."""
        return Pose(self._place.translation, self._place.rotation)

    @property
    def twist(self) -> Array:
        """Velocity (m/s) and angular velocity (rad/s) of the base, (6,), base axes, read-only."""
        return read_only(self._twist)

    @property
    def joint_velocity(self) -> Array:
        """Velocities of the joints, (n,), rad/s (m/s), read-only."""
        return read_only(self._q_dot)

    @property
    def tool(self) -> tuple[Pose, Array]:
        """Pose of tool0 in the world, and its twist (6,), m/s and rad/s, world axes."""
        T, v, omega = self._place.rotation, self._twist[:3], self._twist[3:]
        reach, turn = self.robot.direct_kinematics(self._q)
        moved = self.robot.jacobian(self._q) @ self._q_dot
        velocity = T @ (v + pin.skew(omega) @ reach + moved[:3])
        return self.pose @ Pose(reach, turn), np.concatenate([velocity, T @ (omega + moved[3:])])

    @property
    def momentum(self) -> Array:
        """Linear (N s), then angular momentum about the world's origin (N m s), (6,), world axes.

        That of all bodies and wheels, from their positions and velocities.
        """
        configuration = np.concatenate([pin.SE3ToXYZQUAT(self._place), self._q])
        velocity = np.concatenate([self._twist, self._q_dot])
        found = pin.computeCentroidalMomentum(self._model, self._seen, configuration, velocity)
        angular = found.angular + pin.skew(self._seen.com[0]) @ found.linear
        return np.concatenate([found.linear, angular + self._place.rotation @ self.wheel_momentum])

    @property
    def center_of_mass(self) -> tuple[float, Array]:
        """Mass of all bodies, kg, and their centre of mass in the world, (3,), m."""
        self._blocks(self._q)
        whole = self._data.Ycrb[1]
        return float(whole.mass), np.asarray(self._place.act(whole.lever))

    @property
    def inertia(self) -> Array:
        """Inertia of base, arm and payload about their centre of mass, (3, 3), kg m^2, base axes."""
        self._blocks(self._q)
        return np.array(self._data.Ycrb[1].inertia)

    @property
    def torque(self) -> Array:
        """Torques with which the drives move the bodies, (n,), N m (N); without friction and rotors.

        The acceleration is that of the last period on average.
        """
        M = self._blocks(self._q)
        velocity = np.concatenate([self._twist, self._q_dot])
        bias = pin.nonLinearEffects(self._model, self._data, self._configuration, velocity)
        push = bias[:6] + M[:6, 6:] @ self._q_ddot
        push[3:] += self._wheel_torque + pin.skew(self._twist[3:]) @ self.wheel_momentum
        acceleration = -np.linalg.solve(M[:6, :6], push)
        return np.asarray(bias[6:] + M[:6, 6:].T @ acceleration + M[6:, 6:] @ self._q_ddot)

    def step(
        self, q: ArrayLike, q_dot: ArrayLike, period: float, wheel_torque: ArrayLike = (0.0, 0.0, 0.0)
    ) -> None:
        """Advance while the joints move to a position and velocity.

        Args:
            q: Joint positions at the end, (n,), rad (m).
            q_dot: Joint velocities at the end, (n,), rad/s.
            period: s; divided into steps of at most 5 ms.
            wheel_torque: On the wheels, constant, (3,), N m, base axes; the base feels the opposite.

        Raises:
            InvalidInputError: values of another shape or not finite, or a period not above zero.
        """
        q, q_dot = finite_state(q, q_dot, self._n)
        self._wheel_torque = np.array(finite_vector(wheel_torque, 3, 'wheel_torque'))
        steps = ceil(positive(period, 'period', 's') / LONGEST_STEP * (1.0 - 1e-9))
        h, wheels = period / steps, self.wheel_momentum
        path = (self._q, period * self._q_dot, np.array(q), period * q_dot)
        self._q_ddot = (q_dot - self._q_dot) / period
        for k in range(steps):
            rows = [self._row(path, (k + part) / steps, period) for part in (0.0, 0.5, 1.0)]
            stored = [wheels + (k + part) * h * self._wheel_torque for part in (0.0, 0.5, 1.0)]
            self._runge_kutta(rows, stored, h)
        self._q, self._q_dot = path[2], np.array(q_dot)
        self.wheel_momentum = read_only(wheels + period * self._wheel_torque)
        self._twist = self._twist_of(self._place, self._row(path, 1.0, period), self.wheel_momentum)

    def stop_joints(self) -> None:
        """Hold the joints where they are, by their brakes; what they had of the momentum goes to the base."""
        self._hold(np.zeros(self._n))

    def take(self, payload: Payload, momentum: ArrayLike, *, impact_inertia: ArrayLike | None = None) -> None:
        """Carry a body from now on that is fixed to tool0, and with it its momentum.

        The impact is that of rigid bodies. Joints that hold keep their velocities. Those that yield have no
        impulse from their drives: with the generalised momenta p of the bodies before it,
        (M + I) v = p + J^T P + I v_before for all coordinates, where P is the momentum of the body at the
        tool and I the inertia of the rotors (R. Featherstone, Rigid Body Dynamics Algorithms, 2008,
        section 11.7).

        Args:
            payload: The body, seen from tool0.
            momentum: That it had before, (6,), as `momentum`.
            impact_inertia: Of the drives' rotors at joints that yield, (n,), kg m^2 (kg); None for joints
                that hold.

        Raises:
            InvalidInputError: a momentum or inertia of another shape or not finite.
        """
        momentum = finite_vector(momentum, 6, 'momentum')
        q_dot = self._q_dot
        if impact_inertia is not None:
            rotors = np.concatenate([np.zeros(6), finite_vector(impact_inertia, self._n, 'impact_inertia')])
            M, p = self._struck(payload, momentum)
            p += rotors * np.concatenate([self._twist, q_dot])
            q_dot = np.asarray(np.linalg.solve(M + np.diag(rotors), p)[6:], dtype=np.float64)
        self._h = self._h + momentum
        self._carry(self.payload + payload)
        self._hold(q_dot)

    def impulse(self, payload: Payload, momentum: ArrayLike) -> Array:
        """Impulses in the joints if they hold while the robot takes a body, (n,), N m s (N s); see `take`."""
        M, p = self._struck(payload, finite_vector(momentum, 6, 'momentum'))
        twist = np.linalg.solve(M[:6, :6], p[:6] - M[:6, 6:] @ self._q_dot)
        return np.asarray(M[6:, :6] @ twist + M[6:, 6:] @ self._q_dot - p[6:])

    def _struck(self, payload: Payload, momentum: Array) -> tuple[Array, Array]:
        """Mass matrix with a body that is taken, and the generalised momenta (6 + n,) of both before."""
        p = self._blocks(self._q) @ np.concatenate([self._twist, self._q_dot])
        tool = self._model.getFrameId('tool0')
        J = pin.computeFrameJacobian(
            self._model, self._data, self._configuration, tool, pin.LOCAL_WORLD_ALIGNED
        )
        brought = self._place.actInv(pin.Force(momentum)).vector
        reach, _ = self.robot.direct_kinematics(self._q)
        brought[3:] -= np.cross(reach, brought[:3])
        model = body_model(self.robot, self.payload + payload, floating=True)
        M = np.array(pin.crba(model, model.createData(), self._configuration))
        return M, p + J.T @ brought

    def joint_dynamics(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        """What the drives move: mass matrix (n, n), and torques (n,) N m (N) without acceleration.

        The base follows by the conservation of momentum: M_rr - M_rb M_bb^-1 M_br (Umetani and Yoshida 1989).
        """
        M = self._blocks(q)
        S = np.linalg.solve(M[:6, :6], M[:6, 6:])
        twist = self._twist_of(self._place, (M[:6, :6], M[:6, 6:] @ q_dot), self.wheel_momentum)
        velocity = np.concatenate([twist, q_dot])
        bias = pin.nonLinearEffects(self._model, self._data, self._configuration, velocity)
        push = bias[:6].copy()
        push[3:] += self._wheel_torque + pin.skew(twist[3:]) @ self.wheel_momentum
        return M[6:, 6:] - M[:6, 6:].T @ S, bias[6:] - S.T @ push

    def _hold(self, q_dot: Array) -> None:
        self._q_dot, self._q_ddot = q_dot, np.zeros(self._n)
        M = self._blocks(self._q)
        self._twist = self._twist_of(self._place, (M[:6, :6], M[:6, 6:] @ q_dot), self.wheel_momentum)

    def _blocks(self, q: Array) -> Array:
        """Mass matrix (6 + n, 6 + n)."""
        self._configuration[7:] = q
        return np.array(pin.crba(self._model, self._data, self._configuration))

    def _row(self, path: tuple[Array, ...], s: float, period: float) -> tuple[Array, Array]:
        """M_bb (6, 6) and the momentum of the joints' motion (6,) at a part of the path of a period."""
        q0, v0, q1, v1 = path
        a, b = q1 - q0, v0 + v1
        q = q0 + s * (v0 + s * (3.0 * a - v0 - b + s * (b - 2.0 * a)))
        q_dot = (v0 + s * (2.0 * (3.0 * a - v0 - b) + 3.0 * s * (b - 2.0 * a))) / period
        M = self._blocks(q)
        return M[:6, :6], M[:6, 6:] @ q_dot

    def _twist_of(self, place: pin.SE3, row: tuple[Array, Array], wheels: Array) -> Array:
        rest = place.actInv(pin.Force(self._h)).vector - row[1]
        rest[3:] -= wheels
        return np.asarray(np.linalg.solve(row[0], rest))

    def _runge_kutta(self, rows: list[tuple[Array, Array]], wheels: list[Array], h: float) -> None:
        place = self._place

        def rate(moved: Array, at: int) -> Array:
            step = pin.exp6(moved)
            return np.asarray(pin.Jlog6(step) @ self._twist_of(place * step, rows[at], wheels[at]))

        d1 = self._twist_of(place, rows[0], wheels[0])
        d2 = rate(0.5 * h * d1, 1)
        d3 = rate(0.5 * h * d2, 1)
        d4 = rate(h * d3, 2)
        moved = place * pin.exp6(h / 6.0 * (d1 + 2.0 * d2 + 2.0 * d3 + d4))
        self._place = pin.SE3(pin.Quaternion(moved.rotation).normalized(), moved.translation)
